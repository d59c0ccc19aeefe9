// SPDX-License-Identifier: BSD-3-Clause
#include "replay_node.hpp"

#include <fmt/format.h>

namespace rf {
namespace {

constexpr std::size_t kMaxSinceLast = 4096;

Side sideOf(const std::string& channel, const std::string& frame_channel) {
  return channel == frame_channel ? Side::kBulk : Side::kState;
}

LogReader openLog(const std::string& path) {
  try {
    return LogReader(path);
  } catch (const std::runtime_error& e) {
    throw InputError(e.what());
  }
}

}  // namespace

ReplayNode::ReplayNode(Service& service, const ReplayOptions& options)
    : service_(service),
      options_(options),
      channels_(options.channels),
      log_(openLog(options.log)),
      gate_(service, options.lockstep) {}

std::optional<ReplayNode::Frame> ReplayNode::frameIn(const LogEvent& event) {
  const auto frame = unpack<bot_core::images_t>(event.data);
  if (frame) return Frame{frame->utime, frame->seq};
  service_.badInput(event.channel + ": " + frame.error);
  return std::nullopt;
}

void ReplayNode::send(const LogEvent& event) {
  service_.send(sideOf(event.channel, options_.frame_channel), event.channel, event.data);
}

void ReplayNode::awaitLast() {
  if (!last_ || options_.speed > 0) return;
  const auto again = [&] {
    if (camera_) send(*camera_);
    for (const LogEvent& event : since_last_) send(event);
  };
  gate_.awaitResult(last_->utime, last_->seq, again);
}

void ReplayNode::pace(std::int64_t utime) {
  if (options_.speed <= 0) return;
  if (!first_utime_) first_utime_ = utime;
  const auto due = start_ + std::chrono::microseconds(static_cast<std::int64_t>(
                                static_cast<double>(utime - *first_utime_) / options_.speed));
  while (service_.running() && Clock::now() < due) {
    service_.wait(std::chrono::duration_cast<std::chrono::milliseconds>(
        std::min<Clock::duration>(due - Clock::now(), std::chrono::milliseconds(20)) +
        std::chrono::milliseconds(1)));
    gate_.discard();
  }
}

void ReplayNode::play() {
  start_ = Clock::now();
  while (service_.running()) {
    const auto event = log_.next();
    if (!event) break;
    if (!std::regex_match(event->channel, channels_)) continue;
    service_.monitor().input();
    pace(event->utime);
    if (event->channel == "RF_CAMERA") camera_ = *event;
    if (event->channel == options_.frame_channel) {
      const auto frame = frameIn(*event);
      if (!frame) continue;
      if (last_ && frame->utime == last_->utime)
        continue;  // recorded twice: lockstep had sent it again
      const auto sent = Clock::now();
      awaitLast();
      const double ms = std::chrono::duration<double, std::milli>(Clock::now() - sent).count();
      service_.monitor().output(frame->seq, 0, ms);
      last_ = frame;
      since_last_.clear();
    }
    if (since_last_.size() < kMaxSinceLast) since_last_.push_back(*event);
    send(*event);
    service_.setState(ServiceState::kRunning, "running");
  }
  if (service_.running()) awaitLast();
  if (log_.damages() > 0) {
    service_.warn(fmt::format("{}: {} damaged places, {} bytes skipped", options_.log,
                              log_.damages(), log_.skippedBytes()));
  }
  if (log_.truncated())
    service_.warn(options_.log + ": the last event is incomplete (truncated log)");
  if (!last_) throw InputError(options_.log + ": no frame on channel " + options_.frame_channel);
  service_.setState(ServiceState::kFinished, "the log is at its end");
}

}  // namespace rf
