// SPDX-License-Identifier: BSD-3-Clause
#include "relay_node.hpp"

#include <fmt/format.h>

#include "timing.hpp"

namespace rf {
namespace {

/// Colour older than this against its depth is said once in a while: the driver pairs with the LAST
/// one.
constexpr std::int64_t kColourGapUs = 50000;

}  // namespace

RelayNode::RelayNode(Service& service, const std::string& from, const std::string& to,
                     const Camera& camera)
    : service_(service),
      from_(from),
      to_(to),
      camera_(camera),
      frames_(service.listen(Side::kBulk, from, 4)) {}

bool RelayNode::step() {
  const auto now = std::chrono::steady_clock::now();
  if (now - camera_sent_ > kCameraGap) {
    service_.send(Side::kState, "RF_CAMERA",
                  pack(CameraInfo{last_utime_, "LCM channel " + from_, camera_}));
    camera_sent_ = now;
  }
  bool any = false;
  while (auto frame = service_.take<bot_core::images_t>(frames_)) {
    relay(std::move(frame->first), frame->second);
    any = true;
  }
  service_.commands();
  return any;
}

void RelayNode::relay(EncodedFrame frame, std::chrono::steady_clock::time_point arrival) {
  service_.monitor().input();
  if (frame.width != camera_.width || frame.height != camera_.height) {
    service_.badInput(fmt::format("{}: the frame is {}x{}, the camera {}x{}", from_, frame.width,
                                  frame.height, camera_.width, camera_.height));
    return;
  }
  if (next_seq_ > 0 && frame.utime <= last_utime_) {
    service_.badInput(
        fmt::format("{}: utime {} after {}: time must increase", from_, frame.utime, last_utime_));
    return;
  }
  if (const auto whole = decode(frame); !whole) {
    service_.badInput(from_ + ": " + whole.error);
    return;
  }
  if (std::abs(frame.utime - frame.colour_utime) > kColourGapUs) {
    service_.warn(fmt::format("{}: colour and depth are {} ms apart", from_,
                              (frame.utime - frame.colour_utime) / 1000));
  }
  frame.seq = next_seq_++;
  last_utime_ = frame.utime;
  if (!service_.send(Side::kBulk, to_, pack(frame))) return;
  service_.send(
      Side::kState, "RF_FRAME_TICK",
      pack(FrameTick{frame.utime, frame.colour_utime, frame.seq, TickState::kPublished, ""}));
  const auto ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - arrival).count();
  service_.monitor().output(frame.seq, ms, ms);
  service_.setState(ServiceState::kRunning, "running");
}

}  // namespace rf
