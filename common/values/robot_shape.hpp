// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/se3.hpp"

namespace rf {

/// Solids that a robot is described by. The numbers are those on the wire.
enum class RobotShapeKind : std::int8_t {
  kBox = 0,
  kCylinder = 1,  ///< its axis is z, its centre the origin
  kSphere = 2,
};

/// A solid of the robot itself, posed in the camera frame of one frame.
struct PosedShape {
  RobotShapeKind kind = RobotShapeKind::kBox;
  /// Metres, all positive: half extents of a box, (r, r, half length) of a cylinder, (r, r, r) of a
  /// sphere.
  Vec3 half = Vec3::Zero();
  SE3 T_CS;  ///< shape -> camera
  bool operator==(const PosedShape&) const = default;
};

/// As many shapes as a motion prior may carry.
inline constexpr std::size_t kMaxRobotShapes = 256;

}  // namespace rf
