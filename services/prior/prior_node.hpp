// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "messaging/service.hpp"
#include "messaging/stream_order.hpp"
#include "pipeline/prior_stage.hpp"
#include "robot_feed.hpp"

namespace rf {

struct PriorOptions {
  std::string
      camera_channel;  ///< live bot_core.pose_t of the body that carries the camera; empty: none
  std::string object_channel;  ///< live bot_core.pose_t of the object; empty: none
  bool robot_live = false;     ///< the stage's robot speaks on channels
  RobotChannels robot;         ///< which; only looked at when it does
  int wait_ms = 100;           ///< how long a frame waits for live samples beyond its time
};

/// Answers every frame tick with the motion prior of the frame pair; a repeated tick gets the same
/// answer.
class PriorNode {
 public:
  PriorNode(Service& service, PriorStage stage, const PriorOptions& options);
  /// Takes what arrived and answers at most one tick. True when more can be done at once.
  bool step();

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    FrameTick tick;
    Clock::time_point arrival;
  };

  void takePoses();
  void takePose(const char* source, const std::string& channel, const StampedPose& pose,
                PoseVerdict verdict);
  void takeTick(const FrameTick& tick, Clock::time_point arrival);
  void answer(const Waiting& waiting);

  Service& service_;
  PriorStage stage_;
  PriorOptions options_;
  bool live_;
  Inbox::Box ticks_;
  Inbox::Box camera_poses_ = 0;
  Inbox::Box object_poses_ = 0;
  std::optional<RobotFeed> robot_feed_;
  StreamOrder order_;
  std::deque<Waiting> waiting_;
  std::map<std::int64_t, Bytes> answered_;  ///< by utime
};

}  // namespace rf
