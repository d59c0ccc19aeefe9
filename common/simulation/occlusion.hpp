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
  /// Whether the segment from + t d surely misses the ball about all solids: spares most rays the
  /// divisions of the boxes.
  bool passesBy(const Eigen::Vector3f& from, const Eigen::Vector3f& d) const;
  std::vector<Solid> solids_;
  std::vector<Node> nodes_;
  Eigen::Vector3f centre_ = Eigen::Vector3f::Zero();
  float square_radius_ = 0;  ///< of the ball, with a margin for rounding
};

}  // namespace rf::sim
