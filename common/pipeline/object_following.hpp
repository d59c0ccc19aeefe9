// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/object_life.hpp"
#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// What segmentation says of the object, and what is remembered of it.
ObjectSigns signsOf(const SegmentationResult& segmentation, const FusionState& state);

/// Moves the object to this frame as `action` says, after the camera: born where it is seen to
/// move, refined against its own model while it moves (paper section V), constant in the world
/// while it rests, where its prior takes it while segmentation does not see it - and found again
/// there by its model, without a mask. Sets object.T_FC, T_WO and object_pose. Returns whether the
/// frame may be fused into the object's model.
bool followObject(const FusionInput& frame, const SegmentationResult& segmentation,
                  ObjectAction action, FusionState& state);

/// Keeps the list of places where the object stood: its start, and wherever it comes to rest.
void notePlace(ObjectAction action, FusionState& state);

/// While it rests the object's pose is an assumption; the image may confirm or refute it. Needs the
/// object's prediction at this frame.
void judgeRestingObject(const FusionInput& frame, FusionState& state);

}  // namespace rf
