// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/object_life.hpp"
#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"
#include "pipeline/map_update.hpp"
#include "values/model_state.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Standard deviation of a position in its most uncertain direction, metres.
double positionSigma(const Mat6& covariance);

/// A tracked pose that is less certain than kTrustedSigma becomes degraded.
void demoteUncertain(BodyPose& pose);

/// Completes the covariances of this frame's poses by that of the maps that they were aligned to,
/// lowers the health of poses that are too uncertain, and notes what the frame adds to the maps'
/// uncertainty. Needs both predictions at this frame, before fusion. Poses in the world are
/// uncertain since the start; the object's frame is defined by its pose in the camera at birth,
/// which is exact therefore.
void settleUncertainty(const FusionInput& frame, const SegmentationResult& segmentation,
                       ObjectAction action, MayFuse may, FusionState& state);

}  // namespace rf
