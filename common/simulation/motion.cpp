// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rf::sim {
namespace {

constexpr int kStepsPerSegment = 200;

Eigen::Vector2d catmullRom(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                           const Eigen::Vector2d& c, const Eigen::Vector2d& d, double u) {
  const Eigen::Vector2d linear = c - a;
  const Eigen::Vector2d square = 2 * a - 5 * b + 4 * c - d;
  const Eigen::Vector2d cube = -a + 3 * b - 3 * c + d;
  return b + 0.5 * (u * linear + u * u * square + u * u * u * cube);
}

}  // namespace

Profile::Profile(std::vector<std::pair<double, double>> knots) : knots_(std::move(knots)) {
  if (knots_.empty()) throw std::invalid_argument("Profile: no knots");
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    if (!(knots_[i].first > knots_[i - 1].first)) {
      throw std::invalid_argument("Profile: knot times must increase");
    }
  }
}

double Profile::at(double t) const {
  if (t <= knots_.front().first) return knots_.front().second;
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    if (t > knots_[i].first) continue;
    const auto& [t0, v0] = knots_[i - 1];
    const double u = (t - t0) / (knots_[i].first - t0);
    return v0 + (knots_[i].second - v0) * u * u * (3 - 2 * u);
  }
  return knots_.back().second;
}

double Profile::integral(double t) const {
  double sum = 0;
  for (std::size_t i = 1; i < knots_.size(); ++i) {
    const auto& [t0, v0] = knots_[i - 1];
    const double width = knots_[i].first - t0;
    const double u = std::clamp((t - t0) / width, 0.0, 1.0);
    sum += width * (v0 * u + (knots_[i].second - v0) * (u * u * u - 0.5 * u * u * u * u));
  }
  return sum + knots_.back().second * std::max(0.0, t - knots_.back().first);
}

PlanarPath::PlanarPath(const std::vector<Eigen::Vector2d>& waypoints) {
  if (waypoints.size() < 2) throw std::invalid_argument("PlanarPath: needs two way points");
  const std::size_t n = waypoints.size();
  points_.push_back(waypoints.front());
  arc_.push_back(0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Eigen::Vector2d before =
        i > 0 ? waypoints[i - 1] : Eigen::Vector2d(2 * waypoints[0] - waypoints[1]);
    const Eigen::Vector2d after =
        i + 2 < n ? waypoints[i + 2] : Eigen::Vector2d(2 * waypoints[n - 1] - waypoints[n - 2]);
    for (int k = 1; k <= kStepsPerSegment; ++k) {
      const double u = static_cast<double>(k) / kStepsPerSegment;
      const Eigen::Vector2d p = catmullRom(before, waypoints[i], waypoints[i + 1], after, u);
      arc_.push_back(arc_.back() + (p - points_.back()).norm());
      points_.push_back(p);
    }
  }
}

Eigen::Vector2d PlanarPath::at(double s) const {
  if (s <= 0) return points_.front();
  if (s >= arc_.back()) return points_.back();
  const auto upper = std::upper_bound(arc_.begin(), arc_.end(), s);
  const auto i = static_cast<std::size_t>(upper - arc_.begin());
  const double u = (s - arc_[i - 1]) / (arc_[i] - arc_[i - 1]);
  return (1 - u) * points_[i - 1] + u * points_[i];
}

PlanarMotion::PlanarMotion(PlanarPath path, Profile speed_shape)
    : path_(std::move(path)), speed_(std::move(speed_shape)) {
  const double total = speed_.integral(speed_.end());
  if (!(total > 0)) throw std::invalid_argument("PlanarMotion: the speed profile never moves");
  scale_ = path_.length() / total;
}

Eigen::Vector2d PlanarMotion::position(double t) const { return path_.at(travelled(t)); }

SE3 cameraPose(const Eigen::Vector2d& place, double height, double yaw, double down) {
  const Vec3 forward(std::cos(yaw) * std::cos(down), std::sin(yaw) * std::cos(down),
                     -std::sin(down));
  const Vec3 right(std::sin(yaw), -std::cos(yaw), 0);
  Mat3 R_WC;
  R_WC.col(0) = right;
  R_WC.col(1) = forward.cross(right);
  R_WC.col(2) = forward;
  return {R_WC, Vec3(place.x(), place.y(), height)};
}

SE3 bodyPose(const Eigen::Vector2d& place, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), Vec3(place.x(), place.y(), 0)};
}

}  // namespace rf::sim
