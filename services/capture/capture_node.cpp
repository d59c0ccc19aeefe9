// SPDX-License-Identifier: BSD-3-Clause
#include "capture_node.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "messaging/log_source.hpp"
#include "timing.hpp"

namespace rf {

CaptureNode::CaptureNode(Service& service, std::unique_ptr<FrameSource> source,
                         const CodecOptions& codec, const CaptureOptions& options, bool lockstep,
                         std::string source_name)
    : service_(service),
      source_(std::move(source)),
      codec_(codec),
      options_(options),
      lockstep_(lockstep),
      source_name_(std::move(source_name)),
      gate_(service, options.lockstep) {}

std::optional<CaptureNode::Prepared> CaptureNode::prepare() {
  const auto start = Clock::now();
  const auto sourced = source_->next();
  if (!sourced) return std::nullopt;
  Prepared out;
  out.tick.utime = sourced->utime;
  out.tick.seq = sourced->seq;
  if (!sourced->frame) {
    out.tick.state = TickState::kLost;
    out.tick.reason = sourced->problem.substr(0, 1000);
    return out;
  }
  out.tick.colour_utime = sourced->frame->colour_utime;
  // A log's frames went through the codec once; they pass as they are.
  const auto* log = dynamic_cast<const LcmLogSource*>(source_.get());
  out.frame = pack(log != nullptr ? log->encoded() : encode(*sourced->frame, codec_));
  out.ms = milliseconds(Clock::now() - start);
  return out;
}

void CaptureNode::prefetch() {
  next_ = std::async(std::launch::async, [this] { return prepare(); });
}

void CaptureNode::play() {
  play_start_ = Clock::now();
  sendCamera();
  prefetch();
  while (service_.running()) {
    const auto prepared = next_.get();
    if (!prepared) {
      service_.send(Side::kState, "RF_FRAME_TICK",
                    pack(FrameTick{last_utime_, 0, last_seq_ + 1, TickState::kEnd, ""}));
      service_.setState(ServiceState::kFinished, "every frame was sent");
      return;
    }
    prefetch();
    step(*prepared);
  }
  next_.wait();
}

void CaptureNode::step(const Prepared& prepared) {
  last_utime_ = prepared.tick.utime;
  last_seq_ = prepared.tick.seq;
  if (!lockstep_) pace(prepared.tick.utime);
  if (prepared.tick.state == TickState::kLost) {
    service_.badInput(fmt::format("frame {}: {}", prepared.tick.seq, prepared.tick.reason));
    service_.send(Side::kState, "RF_FRAME_TICK", pack(prepared.tick));
    return;
  }
  service_.monitor().input();
  const auto sent = Clock::now();
  if (!sendFrame(prepared)) return;
  if (lockstep_) {
    const auto again = [&] {
      sendCamera();
      sendFrame(prepared);
    };
    gate_.awaitResult(prepared.tick.utime, prepared.tick.seq, again, [this] { refreshCamera(); });
  }
  service_.monitor().output(prepared.tick.seq, prepared.ms, milliseconds(Clock::now() - sent));
  service_.setState(ServiceState::kRunning, "running");
}

void CaptureNode::refreshCamera() {
  if (Clock::now() - camera_sent_ > kCameraGap) sendCamera();
}

void CaptureNode::sendCamera() {
  service_.send(Side::kState, "RF_CAMERA",
                pack(CameraInfo{last_utime_, source_name_, source_->camera()}));
  camera_sent_ = Clock::now();
}

bool CaptureNode::sendFrame(const Prepared& prepared) {
  refreshCamera();
  if (!service_.send(Side::kBulk, options_.channel, prepared.frame)) {
    FrameTick lost = prepared.tick;
    lost.state = TickState::kLost;
    lost.reason = fmt::format("message of {} bytes could not be sent", prepared.frame.size());
    service_.send(Side::kState, "RF_FRAME_TICK", pack(lost));
    service_.monitor().lost(1);
    return false;
  }
  service_.send(Side::kState, "RF_FRAME_TICK", pack(prepared.tick));
  return true;
}

void CaptureNode::pace(std::int64_t utime) {
  if (!first_utime_) first_utime_ = utime;
  if (options_.speed <= 0) return;
  const auto due = play_start_ + std::chrono::microseconds(static_cast<std::int64_t>(
                                     static_cast<double>(utime - *first_utime_) / options_.speed));
  while (service_.running() && Clock::now() < due) {
    service_.wait(
        std::min(std::chrono::duration_cast<std::chrono::milliseconds>(due - Clock::now()) +
                     std::chrono::milliseconds(1),
                 std::chrono::milliseconds(kPoll)));
    gate_.discard();
    refreshCamera();
  }
}

}  // namespace rf
