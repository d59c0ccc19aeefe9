// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/se3.hpp"
#include "mapping/surfel_map.hpp"

namespace rf {

/// A place where the object stood still, in the static map's frame F.
struct RestPlace {
  SE3 T_FO;
  double reach_m = 0;     ///< how near to the object's surface a static surfel coincides with it
  std::int32_t left = 0;  ///< frame counter when the object was there, or leaving it, last
  bool open = true;       ///< it still is
};

/// Removes from the static map what was the object: two bodies cannot share a place, so a static
/// surfel that coincides with a stable surfel of the object at a place where the object stood
/// (within reach_m, facing the same side) was measured on the object - unless it was seen
/// again after the object had left. This needs no view of what lies behind, and works for the time
/// before the object was known to be one. Returns the number of removed surfels; ids change as by
/// SurfelMap::compact. Looks at blocks around the places alone.
std::int64_t removeShared(const SurfelMap& object, const std::vector<RestPlace>& places,
                          float stable_logit, SurfelMap& world);

}  // namespace rf
