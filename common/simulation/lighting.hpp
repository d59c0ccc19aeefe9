// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/occlusion.hpp"
#include "simulation/world.hpp"

namespace rf::sim {

/// Light that falls on a surface, linear; 1 is about what the floor in the middle of the room gets.
struct Incident {
  Eigen::Vector3f direct = Eigen::Vector3f::Zero();  ///< from the lamps
  float ambient = 0;                                 ///< from everywhere else
};

/// The lamps seen as a few points each.
class LampLight {
 public:
  explicit LampLight(const World& world);

  /// Light of the lamps on a point with the given normal (world frame), where `hides` (may be
  /// empty) stands in the way; `unhidden`, when not null, gets the same without it.
  Eigen::Vector3f at(const Eigen::Vector3f& p, const Eigen::Vector3f& n, const Occlusion& hides,
                     Eigen::Vector3f* unhidden = nullptr) const;

  struct Point {
    Eigen::Vector3f place;
    Eigen::Vector3f power;
  };
  /// A lamp as a ball about its points.
  struct Group {
    Eigen::Vector3f centre;
    float radius = 0;
    std::vector<Point> points;
  };
  const std::vector<Group>& groups() const { return groups_; }

 private:
  std::vector<Group> groups_;
  float scale_ = 1;
};

/// Light on the static world, computed once: soft shadows of the furniture and darker corners, on a
/// grid of a few centimetres on every face.
class BakedLight {
 public:
  BakedLight(const World& world, const LampLight& lamps);

  /// At a surface point of a static primitive; `at` as from surfaceCoordinates().
  Incident sample(int primitive, int face, const Eigen::Vector2f& at) const;

 private:
  struct Patch {
    int first = -1;
    int columns = 0, rows = 0;
    float columns_per_metre = 0, rows_per_metre = 0;
  };
  std::vector<std::array<Patch, 6>> patches_;
  std::vector<Incident> values_;
};

/// Ambient light for a surface that looks along n (world frame), before corners darken it.
float ambientLight(const Eigen::Vector3f& n);

}  // namespace rf::sim
