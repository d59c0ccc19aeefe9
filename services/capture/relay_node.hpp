// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include "messaging/service.hpp"
#include "messaging/stream_order.hpp"

namespace rf {

/// Turns a foreign live stream of bot_core.images_t (openni2-camera-lcm) into ours: checks each
/// frame, numbers it, adds tick and calibration. The images pass unchanged.
class RelayNode {
 public:
  RelayNode(Service& service, const std::string& from, const std::string& to, const Camera& camera);
  /// Relays what arrived. True when there was anything.
  bool step();

 private:
  void relay(EncodedFrame frame, std::chrono::steady_clock::time_point arrival);

  Service& service_;
  std::string from_;
  std::string to_;
  Camera camera_;
  Inbox::Box frames_;
  std::int64_t next_seq_ = 0;
  std::int64_t last_utime_ = 0;
  std::chrono::steady_clock::time_point camera_sent_;
};

}  // namespace rf
