// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/se3.hpp"

namespace rf::calibration {

/// Seconds by which the end of one row and the start of the next differ when they adjoin.
inline constexpr double kSameTime = 1e-9;

/// Diagonal pattern of a covariance, translation first: alike in all directions of each.
inline Mat6 isotropic(double translation, double rotation) {
  Vec6 v;
  v << Vec3::Constant(translation), Vec3::Constant(rotation);
  return v.asDiagonal();
}

}  // namespace rf::calibration
