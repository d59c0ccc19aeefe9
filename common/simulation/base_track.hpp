// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/se3.hpp"
#include "simulation/motion.hpp"

namespace rf::sim {

/// Velocity of a base in the plane, in its own frame: x ahead, y left.
struct PlanarTwist {
  double vx = 0;  ///< m/s
  double vy = 0;  ///< m/s
  double wz = 0;  ///< rad/s
};

/// How far a base turned and moved with a constant twist, from its frame before to that after.
SE3 planarStep(const PlanarTwist& twist, double seconds);

/// A wheeled base's drive: its velocity over time, integrated. Rests outside the profiles when they
/// end at zero. Const members are thread-safe.
class BaseTrack {
 public:
  struct Speeds {
    Profile vx, vy, wz;
  };
  /// `start`: T_WB before the drive; `end`: seconds after which the base rests. `lateral_slip`
  /// (seconds): sideways speed out of a curve, per speed ahead and turn.
  BaseTrack(const SE3& start, Speeds speeds, double lateral_slip, double end);

  PlanarTwist twistAt(double t) const;
  /// T_WB; integrated in steps of a millisecond.
  SE3 poseAt(double t) const;

 private:
  Speeds speeds_;
  double lateral_slip_;
  std::vector<SE3> poses_;  ///< every kTrackStep seconds from 0
};

}  // namespace rf::sim
