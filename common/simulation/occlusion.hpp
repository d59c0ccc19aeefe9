// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "simulation/world.hpp"

namespace rf::sim {

/// Answers whether something stands between two points: a bounding volume hierarchy over solids in
/// world coordinates. Const members are thread-safe.
class Occlusion {
 public:
  /// `primitives` name solids of the world; T_WB as from bodyPoses(). Glowing solids (lamps,
  /// windows) hide nothing.
  Occlusion(const World& world, std::span<const SE3> T_WB, std::span<const int> primitives);

  bool empty() const { return solids_.empty(); }
  /// Whether a solid crosses the segment from `from` towards `to` (both ends 1 mm clear).
  bool blocked(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;
  /// Whether the segment comes near any solid at all (a cheap test before many segments).
  bool mayBlock(const Eigen::Vector3f& from, const Eigen::Vector3f& to) const;

 private:
  struct Solid {
    Eigen::Matrix3f R_PW;
    Eigen::Vector3f t_PW;
    Eigen::Vector3f half;
    ShapeKind kind;
    Eigen::Vector3f low, high;  ///< world bounds
  };
  struct Node {
    Eigen::Vector3f low, high;
    int first = 0, count = 0;  ///< solids of a leaf
    int right = -1;            ///< second child; the first one follows its parent
  };
  int build(int first, int count);
  std::vector<Solid> solids_;
  std::vector<Node> nodes_;
};

}  // namespace rf::sim
