// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "geometry/se3.hpp"

namespace rf::sim {

enum class ShapeKind : std::uint8_t {
  kBox = 0,        ///< faces 0..5: -x +x -y +y -z +z
  kCylinder = 1,   ///< axis z, radius half.x; face 0 side, 1 lower cap, 2 upper cap
  kEllipsoid = 2,  ///< half axes; face 0
};

/// One solid of the world. Its frame P sits in the middle; B is the body it belongs to.
struct Primitive {
  ShapeKind kind = ShapeKind::kBox;
  SE3 T_BP;
  Vec3 half = Vec3::Constant(0.5);   ///< half extents, metres
  int body = 0;                      ///< 0 the static world, 1.. moving bodies
  std::array<int, 6> material = {};  ///< per face, index into World::materials
};

/// Where a ray meets a primitive, in units of the ray's direction.
struct ShapeHit {
  float t = 0;  ///< > 0 when hit, else 0
  int face = 0;
};

/// First meeting of the ray o + t d (frame P) with t > near. A ray that starts inside misses.
ShapeHit intersect(ShapeKind kind, const Eigen::Vector3f& half, const Eigen::Vector3f& o,
                   const Eigen::Vector3f& d, float near);

/// Outward unit normal (frame P) at a surface point of a face.
Eigen::Vector3f surfaceNormal(ShapeKind kind, const Eigen::Vector3f& half, int face,
                              const Eigen::Vector3f& p);

/// Coordinates on a face in metres, from its lower left corner seen from outside (v points down,
/// as in pictures); round faces are unrolled.
Eigen::Vector2f surfaceCoordinates(ShapeKind kind, const Eigen::Vector3f& half, int face,
                                   const Eigen::Vector3f& p);

/// Extent of a face in metres.
Eigen::Vector2f surfaceExtent(ShapeKind kind, const Eigen::Vector3f& half, int face);

}  // namespace rf::sim
