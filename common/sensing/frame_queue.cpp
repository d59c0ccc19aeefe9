// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/frame_queue.hpp"

#include <algorithm>

namespace rf {
namespace {

constexpr std::size_t kMaxLost = 256;

bool isWhole(const GrabbedFrame& item) { return item.frame.has_value(); }

}  // namespace

void FrameQueue::push(GrabbedFrame frame) {
  const std::lock_guard lock(mutex_);
  const auto whole = static_cast<std::size_t>(std::count_if(items_.begin(), items_.end(), isWhole));
  if (isWhole(frame) && whole >= capacity_) {
    GrabbedFrame& oldest = *std::find_if(items_.begin(), items_.end(), isWhole);
    oldest.frame.reset();
    oldest.problem = "encoding is behind: a newer frame took its place";
    ++dropped_;
  }
  items_.push_back(std::move(frame));
  if (items_.size() - std::min(whole, capacity_) > kMaxLost) {
    items_.erase(std::find_if_not(items_.begin(), items_.end(), isWhole));
  }
  news_.notify_all();
}

std::optional<GrabbedFrame> FrameQueue::pop(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  if (!news_.wait_for(lock, timeout, [this] { return !items_.empty(); })) return std::nullopt;
  GrabbedFrame out = std::move(items_.front());
  items_.pop_front();
  return out;
}

std::int64_t FrameQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace rf
