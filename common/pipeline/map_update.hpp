// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/object_life.hpp"
#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"

namespace rf {

/// Draws both models at this frame's poses.
void predictModels(ObjectAction action, FusionState& state);

/// Which models may take the frame: their poses are believed.
struct MayFuse {
  bool world = false;
  bool object = false;
};

/// Fuses the frame into the models that may take it (paper section V). Needs the predictions at
/// this frame.
void fuseModels(const FusionInput& frame, ObjectAction action, MayFuse may, FusionState& state);

/// Removes what the sensor looks through, what never became stable, and from the static map what
/// was the object (shared_place).
void cleanModels(const FusionInput& frame, ObjectAction action, MayFuse may, FusionState& state);

}  // namespace rf
