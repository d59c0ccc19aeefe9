// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/se3.hpp"
#include "mapping/surfel_map.hpp"

namespace rf {

/// Moves each surfel by the twist of the time at which it was born: p -> exp(twist) p in the map's
/// frame; `twists` by MapUncertainty::epochOf, surfels born later stay. Ids and blocks stay.
void moveByBirth(const std::vector<Vec6>& twists, SurfelMap& map);

}  // namespace rf
