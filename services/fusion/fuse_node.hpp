// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/result_writer.hpp"
#include "messaging/service.hpp"
#include "messaging/stream_order.hpp"
#include "pipeline/fusion_stage.hpp"
#include "pipeline/pipeline_config.hpp"

namespace rf {

struct FuseOptions {
  std::string frame_channel = "OPENNI_FRAME";
  std::string camera_pose_channel = "RF_POSE_CAMERA_BOT";  ///< bot_core.pose_t; empty: not sent
  std::string object_pose_channel = "RF_POSE_OBJECT_BOT";  ///< bot_core.pose_t; empty: not sent
  std::string output;                                      ///< result folder; empty: none
  bool write_masks = false;
  int frame_wait_ms =
      0;  ///< how long a segmentation waits for its frame; 0: 10000 in lockstep, 200 live
};

/// Joins frames and segmentations by utime, runs the fusion stage, publishes poses and the model
/// state, keeps the result folder, hands out the model on request. A repeated frame gets the newest
/// state again.
class FuseNode {
 public:
  FuseNode(Service& service, const PipelineConfig& config, const FuseOptions& options,
           bool lockstep);
  /// Takes what arrived and fuses at most one frame. True when more can be done at once.
  bool step();
  /// Lists the frames without result as lost and writes the models.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    SegmentationResult segmentation;
    Clock::time_point arrival;
  };

  void takeMessages();
  void takeCamera(const CameraInfo& info);
  void takeFrame(EncodedFrame frame);
  void takeSegmentation(SegmentationResult segmentation, Clock::time_point arrival);
  void takeTick(const FrameTick& tick);
  void listLost();
  void obey(const Command& command);
  void restart();
  void skipWithoutFrame();
  void fuse(const RgbdFrame& frame, const Waiting& waiting);
  void publish(const ModelState& state);
  void queueModel(const Command& command);
  void sendChunks();
  void writeModels(const std::string& folder_name);

  Service& service_;
  PipelineConfig config_;
  FuseOptions options_;
  std::chrono::milliseconds frame_wait_;
  Inbox::Box frames_box_;
  Inbox::Box cameras_;
  Inbox::Box segmentations_box_;
  Inbox::Box ticks_;

  std::optional<Camera> camera_;
  std::unique_ptr<FusionStage> stage_;
  std::unique_ptr<ResultWriter> writer_;
  StreamOrder order_;
  std::map<std::int64_t, EncodedFrame> frames_;  ///< by utime
  std::size_t max_frames_;
  std::deque<Waiting> segmentations_;
  std::optional<SegmentationResult> skipped_;     ///< its motions go before the next one's
  std::map<std::int64_t, FrameTick> unanswered_;  ///< published frames without a result yet, by seq
  std::map<std::int64_t, FrameTick> lost_;  ///< frames that capture gave up, not listed yet, by seq
  Bytes last_state_;
  std::int64_t last_utime_ = 0;

  std::vector<SurfelPoint> model_;
  std::deque<ModelChunk> chunks_;
};

}  // namespace rf
