// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "segmentation/prepared_frame.hpp"
#include "segmentation/segmentation_config.hpp"
#include "values/frame.hpp"
#include "values/model_state.hpp"
#include "values/motion_prior.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// A frame on its way into segmentation: all that depends on it and its prior alone.
struct SegmentationInput {
  PreparedFrame frame;
  Image<std::uint8_t> self;  ///< working pixels that show the robot, if only in part; else empty
  double self_share = 0;     ///< as in SegmentationResult
  double self_behind = 0;
  StageTimes self_ms;  ///< "self", where the robot was looked for
};

/// Motion segmentation as a plain object: values in, values out; no clock but for stage times, no
/// file, no message. Deterministic for every thread count. Not thread-safe, but for prepare() of a
/// frame beside process() of one before.
class SegmentationStage {
 public:
  /// Throws std::invalid_argument when the configuration or the calibration is unusable.
  SegmentationStage(const SegmentationConfig& config, const Camera& camera);
  ~SegmentationStage();

  /// First half of process(): frames in their order. Where the prior brings the robot's own shapes,
  /// its pixels are left out. Throws std::invalid_argument when the frame's size is not the
  /// camera's or a shape is unusable.
  SegmentationInput prepare(const RgbdFrame& frame, const MotionPrior& prior);

  /// Segments frame B against the frames processed before. `prior` is for the pair (last processed
  /// frame, this frame), with kMissing members where nothing is known. `feedback` is the newest
  /// ModelState or null; in lockstep it is that of the previous frame. The robot's own pixels are
  /// labelled kSelfLabel.
  SegmentationResult process(SegmentationInput frame, const MotionPrior& prior,
                             const ModelState* feedback);

  /// Both halves. Throws as prepare() does; the state is then unchanged.
  SegmentationResult process(const RgbdFrame& frame, const MotionPrior& prior,
                             const ModelState* feedback);

  /// Forgets everything, as if new.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rf
