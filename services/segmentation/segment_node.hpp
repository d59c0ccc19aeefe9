// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "messaging/service.hpp"
#include "messaging/stream_order.hpp"
#include "pipeline/pipeline_config.hpp"
#include "pipeline/segmentation_stage.hpp"

namespace rf {

struct SegmentOptions {
  std::string frame_channel = "OPENNI_FRAME";
  int prior_wait_ms = 0;  ///< how long a frame waits for its prior; 0: 2000 in lockstep, 50 live
  int state_wait_ms =
      0;  ///< lockstep: how long a frame waits for the model state before it; 0: 4000
};

/// Joins frames, priors and feedback by utime, runs the segmentation stage, publishes. A repeated
/// frame gets its result again. In lockstep every frame is taken in order with the model state of
/// the frame before; live the newest frame wins and the newest model state serves.
class SegmentNode {
 public:
  SegmentNode(Service& service, const SegmentationConfig& config, const SegmentOptions& options,
              bool lockstep);
  /// Takes what arrived and does at most one frame. True when more can be done at once.
  bool step();

 private:
  using Clock = std::chrono::steady_clock;
  struct Pending {
    EncodedFrame frame;
    Clock::time_point arrival;
  };

  void takeMessages();
  void takeCamera(const CameraInfo& info);
  void takeFrame(EncodedFrame frame, Clock::time_point arrival);
  void restart();
  /// The prior to use, or nothing while it is worth waiting.
  std::optional<MotionPrior> priorFor(const Pending& pending);
  bool feedbackReady(const Pending& pending) const;
  void process(const Pending& pending, const MotionPrior& prior);

  Service& service_;
  SegmentationConfig config_;
  bool lockstep_;
  std::chrono::milliseconds prior_wait_;
  std::chrono::milliseconds state_wait_;
  Inbox::Box frames_;
  Inbox::Box cameras_;
  Inbox::Box prior_box_;
  Inbox::Box states_;

  std::optional<Camera> camera_;
  std::unique_ptr<SegmentationStage> stage_;
  StreamOrder order_;
  PriorChain priors_;
  std::deque<Pending> pending_;
  std::optional<ModelState> state_;
  Bytes last_result_;
  std::int64_t count_ = 0;
  bool prior_missed_ = false;
};

}  // namespace rf
