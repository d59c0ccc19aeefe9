// SPDX-License-Identifier: BSD-3-Clause
#include "device_node.hpp"

#include <fmt/format.h>

#include <cmath>

#include "timing.hpp"

namespace rf {
namespace {

constexpr std::size_t kMaxReason = 1000;

}  // namespace

DeviceNode::DeviceNode(Service& service, Grabber& grabber, Encoder encoder, std::string channel)
    : service_(service),
      grabber_(grabber),
      encoder_(std::move(encoder)),
      channel_(std::move(channel)) {}

void DeviceNode::step() {
  service_.commands();
  refreshCamera();
  const auto grabbed = grabber_.next(kPoll);
  report();
  if (!grabbed) return;
  last_utime_ = grabbed->utime;
  if (grabbed->frame) {
    publish(*grabbed);
  } else {
    publishLost(*grabbed);
  }
}

void DeviceNode::publish(const GrabbedFrame& grabbed) {
  service_.monitor().input();
  const auto start = Clock::now();
  const Bytes bytes = pack(encoder_(*grabbed.frame));
  const auto encoded = Clock::now();
  if (!service_.send(Side::kBulk, channel_, bytes)) {
    publishLost({grabbed.utime, grabbed.seq, std::nullopt,
                 fmt::format("message of {} bytes could not be sent", bytes.size()), 0,
                 grabbed.arrival});
    return;
  }
  service_.send(Side::kState, "RF_FRAME_TICK",
                pack(FrameTick{grabbed.utime, grabbed.frame->colour_utime, grabbed.seq,
                               TickState::kPublished, ""}));
  service_.monitor().output(grabbed.seq, milliseconds(encoded - start),
                            milliseconds(Clock::now() - grabbed.arrival),
                            {{"encode", milliseconds(encoded - start)},
                             {"colour_gap", std::abs(static_cast<double>(grabbed.gap_us)) / 1000}});
}

void DeviceNode::publishLost(const GrabbedFrame& grabbed) {
  service_.monitor().lost(1);
  service_.warn(fmt::format("frame {}: {}", grabbed.seq, grabbed.problem));
  service_.send(Side::kState, "RF_FRAME_TICK",
                pack(FrameTick{grabbed.utime, 0, grabbed.seq, TickState::kLost,
                               grabbed.problem.substr(0, kMaxReason)}));
}

void DeviceNode::refreshCamera() {
  const auto camera = grabber_.camera();
  if (!camera || Clock::now() - camera_sent_ < kCameraGap) return;
  service_.send(
      Side::kState, "RF_CAMERA",
      pack(CameraInfo{last_utime_, grabber_.status().text.substr(0, kMaxReason), *camera}));
  camera_sent_ = Clock::now();
}

void DeviceNode::report() {
  for (const std::string& note : grabber_.takeNotes()) service_.info(note);
  const GrabStatus now = grabber_.status();
  for (std::int64_t i = reported_.bad; i < now.bad; ++i) service_.monitor().bad();
  service_.monitor().dropped(now.dropped - reported_.dropped);
  const bool back = now.openings > reported_.openings;
  reported_ = now;
  if (back) camera_sent_ = {};  // another device may have another camera
  const auto state = !now.connected   ? ServiceState::kDegraded
                     : now.frames > 0 ? ServiceState::kRunning
                                      : ServiceState::kWaiting;
  const std::string text = now.connected && now.clock_jumps == 0
                               ? fmt::format("{}; clock drift {:.0f} ppm", now.text, now.drift_ppm)
                               : now.text;
  service_.setState(state, text);
  service_.monitor().setState(state, text);
}

}  // namespace rf
