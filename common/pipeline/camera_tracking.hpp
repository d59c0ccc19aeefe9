// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Moves the camera to this frame: segmentation's motion (or what bridges a gap), refined against
/// the prediction of the static map (paper section V). Sets world.T_FC and camera_pose. Returns
/// whether the frame may be fused into the static map: a pose that contradicts the model must not.
bool trackCamera(const FusionInput& frame, const SegmentationResult& segmentation,
                 FusionState& state);

}  // namespace rf
