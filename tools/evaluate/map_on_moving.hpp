// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "evaluation/moving_pixels.hpp"
#include "values/stamped_pose.hpp"

namespace rf {

/// How much of a result's static.ply lies on what the sequence's true masks call dynamic, seen from
/// `camera` (the result's poses, frames without one are left out). Nothing when there is no
/// static.ply, no mask or no camera.yaml. Throws DatasetError for files that are there but
/// unusable.
std::optional<MapOnMoving> scoreMapOnMoving(const std::string& sequence, const std::string& result,
                                            const std::string& truth_masks,
                                            const Trajectory& camera);

}  // namespace rf
