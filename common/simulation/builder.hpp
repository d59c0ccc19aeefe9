// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>

#include "simulation/paint.hpp"
#include "simulation/world.hpp"

namespace rf::sim {

/// Puts things into a world: shared helpers of the room's and the bodies' builders.
class Builder {
 public:
  Builder(World& world, std::uint64_t seed, std::uint64_t purpose)
      : random_(seed, purpose), world_(world) {}

  Random& random() { return random_; }

  /// Adds a picture, returns its index.
  int texture(Image<Rgb> picture);
  /// Adds a material, returns its index.
  int material(const Material& material);
  int plain(const Rgb& colour, float infrared = 0.6F, float gloss = 0.0F);
  /// A picture that fills each face it is put on.
  int print(Image<Rgb> picture, float infrared = 0.6F, float gloss = 0.03F);
  /// A picture that tiles at the given scale, at an offset of its own.
  int tiling(int texture, float metres_per_texel, float infrared = 0.6F, float gloss = 0.0F);

  /// Adds a box with one material: centre and half extents in the current frame (see place()).
  Primitive& box(const Vec3& centre, const Vec3& half, int material, double yaw = 0);
  Primitive& cylinder(const Vec3& centre, double radius, double half_height, int material);
  Primitive& ellipsoid(const Vec3& centre, const Vec3& half, int material, double yaw = 0);
  /// Any solid, its frame given in a body's frame.
  Primitive& solid(ShapeKind kind, int body, const SE3& T_BP, const Vec3& half, int material);
  /// A cylinder from a to b.
  Primitive& rod(const Vec3& a, const Vec3& b, double radius, int material);

  /// Where the following solids go: their coordinates are mapped by T_BF into body B.
  void place(int body, const SE3& T_BF) {
    body_ = body;
    T_BF_ = T_BF;
  }

 private:
  Primitive& add(ShapeKind kind, const SE3& T_FP, const Vec3& half, int material);
  Random random_;
  World& world_;
  int body_ = 0;
  SE3 T_BF_;
};

/// Extents of the room: walls at x = +-half_x, y = +-half_y.
struct RoomSize {
  double half_x = 3.4;
  double half_y = 2.55;
  double height = 2.7;
};

/// Walls, floor, ceiling, lamps and furniture along the walls. The middle stays free (furniture
/// reaches at most 0.75 m from a wall).
void buildRoom(World& world, const RoomSize& size, std::uint64_t seed);

/// A folding screen in the room: three leaves side by side, a poster on each, as part of the static
/// world. It stands at `place` on the floor, its leaves facing -x, `width` along y.
void buildScreen(World& world, const Eigen::Vector2d& place, double width, double height,
                 std::uint64_t seed);

/// Extents of a carried stack: its base stands on a small wheeled carrier.
struct StackSize {
  Vec3 extent = {0.4, 0.6, 1.0};  ///< of the boxes, metres
  double carrier_height = 0.12;
  bool flush = false;  ///< all layers as large as the base
};

/// A stack of printed cartons on a carrier, as body `body`.
void buildStack(World& world, int body, const StackSize& size, std::uint64_t seed);

/// A printed carton as body `body`, its frame in the middle.
void buildCarton(World& world, int body, const Vec3& half, std::uint64_t seed);

/// A carton held by a hand at the end of a forearm, as body `body`; the body's frame sits in the
/// carton's middle, the arm comes from -z.
void buildHeldCarton(World& world, int body, std::uint64_t seed);

}  // namespace rf::sim
