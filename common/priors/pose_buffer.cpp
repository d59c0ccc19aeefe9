// SPDX-License-Identifier: BSD-3-Clause
#include "priors/pose_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace rf {
namespace {

double seconds(std::int64_t from, std::int64_t to) { return 1e-6 * static_cast<double>(to - from); }

PoseAt between(const StampedPose& a, const StampedPose& b, std::int64_t utime, PriorState state,
               const std::string& reason) {
  const double s = seconds(a.utime, utime) / seconds(a.utime, b.utime);
  return {state, interpolate(a.pose, b.pose, s), reason};
}

}  // namespace

PoseBuffer::PoseBuffer(std::size_t capacity) : capacity_(capacity) {
  if (capacity < 2) throw std::invalid_argument("PoseBuffer: capacity must be 2 or more");
}

PoseVerdict PoseBuffer::add(std::int64_t utime, const SE3& pose) {
  if (!pose.isFinite()) {
    ++counts_.not_finite;
    return PoseVerdict::kNotFinite;
  }
  if (std::abs(pose.q.norm() - 1.0) > kUnitQuaternionTolerance) {
    ++counts_.not_unit;
    return PoseVerdict::kNotUnit;
  }
  if (!poses_.empty() && utime <= poses_.back().utime) {
    ++counts_.not_later;
    return PoseVerdict::kNotLater;
  }
  if (poses_.size() == capacity_) {
    poses_.pop_front();
    ++counts_.evicted;
  }
  poses_.push_back({utime, SE3(pose.q.normalized(), pose.t)});
  ++counts_.accepted;
  return PoseVerdict::kAccepted;
}

void PoseBuffer::reserve(std::size_t capacity) { capacity_ = std::max(capacity_, capacity); }

void PoseBuffer::clear() {
  poses_.clear();
  counts_ = {};
}

PoseAt PoseBuffer::at(std::int64_t utime, double max_gap_s, double max_extrapolation_s) const {
  if (poses_.empty()) return {PriorState::kMissing, SE3(), "no pose received"};
  const auto after =
      std::lower_bound(poses_.begin(), poses_.end(), utime,
                       [](const StampedPose& p, std::int64_t t) { return p.utime < t; });
  if (after != poses_.end() && after->utime == utime) {
    return {PriorState::kValid, after->pose, {}};
  }
  if (after == poses_.end() || after == poses_.begin()) {
    return beyond(utime, max_gap_s, max_extrapolation_s);
  }
  const StampedPose& a = *std::prev(after);
  const double gap = seconds(a.utime, after->utime);
  if (gap > max_gap_s) {
    return {PriorState::kMissing, SE3(),
            fmt::format("gap of {:.3f} s between poses (limit {} s)", gap, max_gap_s)};
  }
  return between(a, *after, utime, PriorState::kValid, {});
}

PoseAt PoseBuffer::beyond(std::int64_t utime, double max_gap_s, double max_extrapolation_s) const {
  const bool late = utime > newest();
  const double distance = late ? seconds(newest(), utime) : seconds(utime, oldest());
  const std::string where = fmt::format("{:.3f} s {}", distance,
                                        late ? "after the newest pose" : "before the oldest pose");
  if (distance > max_extrapolation_s) {
    return {PriorState::kMissing, SE3(),
            fmt::format("{} (limit {} s)", where, max_extrapolation_s)};
  }
  if (poses_.size() < 2) return {PriorState::kMissing, SE3(), where + ", velocity unknown"};
  const StampedPose& a = late ? poses_[poses_.size() - 2] : poses_[0];
  const StampedPose& b = late ? poses_[poses_.size() - 1] : poses_[1];
  if (seconds(a.utime, b.utime) > max_gap_s) {
    return {PriorState::kMissing, SE3(), where + ", velocity unknown across a gap"};
  }
  return between(a, b, utime, PriorState::kExtrapolated, where);
}

}  // namespace rf
