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

/// The default mode: Eq. 1's energies with information-weighted relative priors in one coupled
/// solve, a reference frame several frames back, and competing readings of which motion is whose
/// (docs/ALGORITHM.md). Values in, values out; see SegmentationStage for the contract.
class RigidFusionSegmenter {
 public:
  RigidFusionSegmenter(const SegmentationConfig& config, const Camera& camera);
  ~RigidFusionSegmenter();
  RigidFusionSegmenter(RigidFusionSegmenter&&) noexcept;

  PreparedFrame prepare(const RgbdFrame& frame) const;
  SegmentationResult process(PreparedFrame frame, const MotionPrior& prior,
                             const ModelState* feedback);
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rf
