// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "values/stamped_pose.hpp"

namespace rf::calibration {

/// A trajectory that can be asked at any time, in seconds since an origin. Between poses it follows
/// the geodesic; beyond its ends it goes on at the velocity there. Immutable.
class Path {
 public:
  /// Throws CalibrationError, naming `source`, for fewer than two poses, a pose that is not finite
  /// or not of unit quaternion, and time that does not increase.
  Path(const Trajectory& trajectory, std::int64_t origin, const std::string& source);

  double begin() const { return times_.front(); }
  double end() const { return times_.back(); }
  const std::vector<double>& times() const { return times_; }
  const std::vector<SE3>& poses() const { return poses_; }

  SE3 at(double t) const;
  /// Velocity of the body in its own frame, translation first, averaged over 0.1 s around t.
  Vec6 twistAt(double t) const;
  /// Longest time between neighbouring poses within from..to.
  double longestGap(double from, double to) const;
  /// The path of a body whose steps are scaled: translation and rotation of every step's twist.
  Path scaled(double translation, double rotation) const;

 private:
  Path() = default;
  std::size_t segment(double t) const;

  std::vector<double> times_;
  std::vector<SE3> poses_;
  std::vector<Vec6> steps_;  ///< log of the motion from pose i to i + 1
};

}  // namespace rf::calibration
