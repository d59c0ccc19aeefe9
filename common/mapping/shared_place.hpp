// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/se3.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/surfel_map.hpp"

namespace rf {

/// A place where the object stood still, in the static map's frame F.
struct RestPlace {
  SE3 T_FO;
  std::int32_t left = std::numeric_limits<std::int32_t>::max();  ///< frame counter when it went on
};

/// Removes from the static map what was the object: two bodies cannot share a place, so a static
/// surfel that coincides with a stable surfel of the object at a place where the object stood
/// (within object.shared_m, facing the same side) was measured on the object - unless it was seen
/// again after the object had left. This needs no view of what lies behind, and works for the time
/// before the object was known to be one. Returns the number of removed surfels; ids change as by
/// SurfelMap::compact. Looks at blocks around the places alone.
std::int64_t removeShared(const SurfelMap& object, const std::vector<RestPlace>& places,
                          const FusionConfig& config, SurfelMap& world);

}  // namespace rf
