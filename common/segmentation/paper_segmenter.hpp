// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "geometry/camera.hpp"
#include "segmentation/prepared_frame.hpp"
#include "segmentation/segmentation_config.hpp"
#include "values/frame.hpp"
#include "values/model_state.hpp"
#include "values/motion_prior.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// The modes that follow the publications, from frame to frame, without feedback:
///   rigidfusion-paper  Eq. 1 as published (section IV; docs/ALGORITHM.md "Paper mode")
///   static             StaticFusion's rule: one body, the rest are outliers; no prior
///   static-prior       the same with the prior term of the camera
///   vo                 one robust body, no segmentation, no prior
/// Values in, values out; see SegmentationStage for the contract. The feedback is not used.
class PaperSegmenter {
 public:
  /// Throws std::invalid_argument for any other mode or an unusable calibration.
  PaperSegmenter(const SegmentationConfig& config, const Camera& camera);
  ~PaperSegmenter();
  PaperSegmenter(PaperSegmenter&&) noexcept;

  /// Throws std::invalid_argument when the frame's size is not the camera's.
  PreparedFrame prepare(const RgbdFrame& frame) const;
  SegmentationResult process(PreparedFrame frame, const MotionPrior& prior,
                             const ModelState* feedback);
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rf
