// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/camera.hpp"
#include "geometry/undistort.hpp"
#include "mapping/frame_maps.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/tracker.hpp"
#include "values/frame.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// A frame and its segmentation as every step of fusion needs them, at model resolution.
struct FusionInput {
  FrameMaps maps;
  std::vector<TrackLevel> pyramid;  ///< finest first
  SplitWeights weights;
};

/// Throws std::invalid_argument naming field, value and rule when sizes or times do not fit
/// together or a pose is not finite. Covariances are not judged here: an unusable one is replaced
/// by a wide one.
void checkFusionInput(const RgbdFrame& frame, const SegmentationResult& segmentation,
                      const Camera& camera);

/// Undistorts, reduces and filters a frame that checkFusionInput accepts.
FusionInput prepareFusionInput(const RgbdFrame& frame, const SegmentationResult& segmentation,
                               const Undistorter& undistorter, const FusionConfig& config);

}  // namespace rf
