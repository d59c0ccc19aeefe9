// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/se3.hpp"

namespace rf::sim {

/// A quantity over time that goes smoothly (cubic, flat at both ends) from knot to knot and stays
/// constant outside. Knots are (seconds, value), times increasing.
class Profile {
 public:
  explicit Profile(std::vector<std::pair<double, double>> knots);
  double at(double t) const;
  /// Exact integral from the first knot to t.
  double integral(double t) const;
  double end() const { return knots_.back().first; }

 private:
  std::vector<std::pair<double, double>> knots_;
};

/// A smooth plane curve through way points (Catmull-Rom), by arc length.
class PlanarPath {
 public:
  explicit PlanarPath(const std::vector<Eigen::Vector2d>& waypoints);
  double length() const { return arc_.back(); }
  /// Position after s metres, clamped to the ends.
  Eigen::Vector2d at(double s) const;

 private:
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> arc_;
};

/// Plane-parallel motion: runs along a path at a speed that follows the profile's shape, scaled so
/// that the path's end is reached at the profile's end.
class PlanarMotion {
 public:
  PlanarMotion(PlanarPath path, Profile speed_shape);
  Eigen::Vector2d position(double t) const;
  double speed(double t) const { return scale_ * speed_.at(t); }
  double length() const { return path_.length(); }
  /// Metres gone until t.
  double travelled(double t) const { return scale_ * speed_.integral(t); }

 private:
  PlanarPath path_;
  Profile speed_;
  double scale_;
};

/// Camera pose T_WC: at a place above the floor, optical axis turned by yaw from world x (world z
/// is up), tilted down by `down` radians.
SE3 cameraPose(const Eigen::Vector2d& place, double height, double yaw, double down);

/// Body pose T_WB: origin on the floor, turned by yaw about world z.
SE3 bodyPose(const Eigen::Vector2d& place, double yaw);

}  // namespace rf::sim
