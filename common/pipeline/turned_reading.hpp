// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Mask and world were the wrong way round since the object's birth, and segmentation has turned
/// them: before the frame is tracked, world and object change places. The object has never moved
/// then and is the world: its model joins the static map where it was born, the camera is where it
/// is to that model. What the static map took since that birth was the object; its frame O keeps
/// its place at the birth, so that a trajectory of it goes on. Nothing is done without an object,
/// nor where the models show what the mask says already.
void turnReading(const FusionInput& frame, const SegmentationResult& segmentation,
                 FusionState& state);

}  // namespace rf
