// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "geometry/camera.hpp"
#include "segmentation/segmentation_config.hpp"
#include "values/frame.hpp"
#include "values/model_state.hpp"
#include "values/motion_prior.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Motion segmentation as a plain object: values in, values out; no clock but for stage times, no
/// file, no message. Deterministic for every thread count. Not thread-safe.
class SegmentationStage {
 public:
  /// Throws std::invalid_argument when the configuration or the calibration is unusable.
  SegmentationStage(const SegmentationConfig& config, const Camera& camera);
  ~SegmentationStage();

  /// Segments frame B against the frames processed before. `prior` is for the pair (last processed
  /// frame, this frame), with kMissing members where nothing is known. `feedback` is the newest
  /// ModelState or null; in lockstep it is that of the previous frame. Where the prior brings the
  /// robot's own shapes, its pixels are left out and labelled kSelfLabel. Throws
  /// std::invalid_argument when the frame's size is not the camera's or a shape is unusable; the
  /// state is then unchanged.
  SegmentationResult process(const RgbdFrame& frame, const MotionPrior& prior,
                             const ModelState* feedback);

  /// Forgets everything, as if new.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rf
