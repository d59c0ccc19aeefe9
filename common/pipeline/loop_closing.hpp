// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"

namespace rf {

/// Where surface that was out of view for long is seen beside younger one, the frame is aligned to
/// either alone. What lies between both poses, beyond the noise of the two alignments, is drift, if
/// the map expects that much of itself: it is distributed over the younger pieces by their
/// covariances, a small step a frame, and the camera goes along. Needs the world's prediction at
/// this frame and draws it anew when it moves something. Returns whether steps are left: such a
/// frame should not be fused into either surface.
bool closeLoop(const FusionInput& frame, FusionState& state);

}  // namespace rf
