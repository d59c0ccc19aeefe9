// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "simulation/world.hpp"

namespace rf::sim {

/// What each pixel's ray meets first.
struct SurfaceImage {
  Image<float> z;                 ///< metres along the optical axis; 0 = nothing
  Image<std::int16_t> primitive;  ///< index into World::primitives; -1 = nothing
  Image<std::uint8_t> face;
};

/// A primitive as one camera sees it.
struct ViewedPrimitive {
  Eigen::Matrix3f R_PC;    ///< rotation from the camera to the primitive's frame
  Eigen::Vector3f origin;  ///< camera centre in the primitive's frame
  Eigen::Vector3f half;
  ShapeKind kind;
  float nearest_z = 0;  ///< lower bound of the depths it can cover; < 0: out of view
  int u0 = 0, u1 = -1, v0 = 0, v1 = -1;                  ///< pixel bounds, inclusive
  float u_low = 0, u_high = -1, v_low = 0, v_high = -1;  ///< the same and a pixel more, for rays
};

/// Exact ray casting of a world from one camera pose: a list of primitives per tile of the image,
/// nearest first. Use one object per frame; const members are thread-safe.
class Raycaster {
 public:
  /// T_WB as from bodyPoses(). Throws std::invalid_argument when the counts disagree.
  Raycaster(const World& world, std::span<const SE3> T_WB, const SE3& T_WC);

  struct Hit {
    float z = 0;
    int primitive = -1;
    int face = 0;
  };
  /// Through the pixel position (u, v), which may lie between pixel centres but inside the image.
  Hit cast(float u, float v) const;
  SurfaceImage castAll() const;
  const ViewedPrimitive& viewed(int primitive) const {
    return views_[static_cast<std::size_t>(primitive)];
  }

 private:
  void addToTiles(std::size_t primitive);
  Camera camera_;
  std::vector<ViewedPrimitive> views_;
  int tiles_u_ = 0;
  int tiles_v_ = 0;
  std::vector<std::vector<std::int16_t>> tiles_;
};

}  // namespace rf::sim
