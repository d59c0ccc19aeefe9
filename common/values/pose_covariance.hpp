// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/se3.hpp"
#include "values/health.hpp"

namespace rf {

/// What a pose of one moment is worth.
struct PoseCovariance {
  std::int64_t utime = 0;  ///< microseconds, of the pose
  Health health = Health::kInvalid;
  Mat6 covariance = Mat6::Identity();  ///< right perturbation, translation first: m^2, m rad, rad^2
};

/// In strictly increasing utime.
using PoseCovariances = std::vector<PoseCovariance>;

}  // namespace rf
