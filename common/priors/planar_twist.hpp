// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/se3.hpp"

namespace rf {

/// Velocity of a base on a plane, in its own frame: x forward, y left, turning about z.
struct PlanarTwist {
  double vx = 0;  ///< m/s
  double vy = 0;  ///< m/s
  double wz = 0;  ///< rad/s
};

/// The base's motion T_BaBb under a constant twist: an arc, exact for every angle.
inline SE3 arc(const PlanarTwist& twist, double seconds) {
  Vec6 xi;
  xi << twist.vx, twist.vy, 0, 0, 0, twist.wz;
  return SE3::exp(xi * seconds);
}

}  // namespace rf
