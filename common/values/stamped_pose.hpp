// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/se3.hpp"

namespace rf {

/// A pose at a time; which frames it relates is said where it is used.
struct StampedPose {
  std::int64_t utime = 0;  ///< microseconds
  SE3 pose;
  bool operator==(const StampedPose&) const = default;
};

/// Poses in strictly increasing utime.
using Trajectory = std::vector<StampedPose>;

}  // namespace rf
