// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "messaging/service.hpp"
#include "pipeline/codec.hpp"
#include "sensing/grabber.hpp"

namespace rf {

/// Publishes what a Grabber grabs: calibration, frame and tick, live. Encodes in the caller's
/// thread, so that a slow encoder costs frames (counted, ticked as lost) and never holds up
/// grabbing. While the device is gone the service is degraded and says what it waits for.
class DeviceNode {
 public:
  using Encoder = std::function<EncodedFrame(const RgbdFrame&)>;

  DeviceNode(Service& service, Grabber& grabber, Encoder encoder, std::string channel);
  /// Publishes one frame, or waits a moment for it; keeps state and counts up to date.
  void step();

 private:
  using Clock = std::chrono::steady_clock;

  void publish(const GrabbedFrame& grabbed);
  void publishLost(const GrabbedFrame& grabbed);
  void refreshCamera();
  void report();

  Service& service_;
  Grabber& grabber_;
  Encoder encoder_;
  std::string channel_;
  Clock::time_point camera_sent_;
  std::int64_t last_utime_ = 0;
  GrabStatus reported_;
};

}  // namespace rf
