// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/path.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibration/values.hpp"

namespace rf::calibration {
namespace {

constexpr double kTwistHalfWindow = 0.05;  ///< s; bridges the noise of single samples

void check(const Trajectory& trajectory, std::size_t i, const std::string& source) {
  const StampedPose& p = trajectory[i];
  const double seconds = 1e-6 * static_cast<double>(p.utime);
  if (!p.pose.isFinite()) {
    throw CalibrationError(
        fmt::format("{}: pose {} at {:.6f} s: must be finite", source, i, seconds));
  }
  if (!(std::abs(p.pose.q.norm() - 1.0) <= kUnitQuaternionTolerance)) {
    throw CalibrationError(fmt::format("{}: pose {} at {:.6f} s: quaternion length = {}: must be 1",
                                       source, i, seconds, p.pose.q.norm()));
  }
  if (i > 0 && p.utime <= trajectory[i - 1].utime) {
    throw CalibrationError(fmt::format(
        "{}: pose {}: time = {:.6f} s: must be later than {:.6f} s of the pose before (time goes "
        "backwards or stands still)",
        source, i, seconds, 1e-6 * static_cast<double>(trajectory[i - 1].utime)));
  }
}

}  // namespace

Path::Path(const Trajectory& trajectory, std::int64_t origin, const std::string& source) {
  if (trajectory.size() < 2) {
    throw CalibrationError(
        fmt::format("{}: {} poses: must be at least 2", source, trajectory.size()));
  }
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    check(trajectory, i, source);
    const SE3& pose = trajectory[i].pose;
    times_.push_back(1e-6 * static_cast<double>(trajectory[i].utime - origin));
    poses_.emplace_back(pose.q.normalized(), pose.t);
    if (i > 0) steps_.push_back((poses_[i - 1].inverse() * poses_[i]).log());
  }
}

std::size_t Path::segment(double t) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), t);
  const auto index = std::max<std::ptrdiff_t>(0, std::distance(times_.begin(), after) - 1);
  return std::min<std::size_t>(static_cast<std::size_t>(index), steps_.size() - 1);
}

SE3 Path::at(double t) const {
  const std::size_t i = segment(t);
  const double s = (t - times_[i]) / (times_[i + 1] - times_[i]);
  return poses_[i] * SE3::exp(s * steps_[i]);
}

Vec6 Path::twistAt(double t) const {
  const SE3 before = at(t - kTwistHalfWindow);
  const SE3 after = at(t + kTwistHalfWindow);
  return (before.inverse() * after).log() / (2 * kTwistHalfWindow);
}

double Path::longestGap(double from, double to) const {
  double gap = 0;
  for (std::size_t i = segment(from); i + 1 < times_.size() && times_[i] < to; ++i) {
    gap = std::max(gap, times_[i + 1] - times_[i]);
  }
  return gap;
}

Path Path::scaled(double translation, double rotation) const {
  Path out;
  out.times_ = times_;
  out.poses_.reserve(poses_.size());
  out.steps_.reserve(steps_.size());
  out.poses_.push_back(poses_.front());
  for (const Vec6& step : steps_) {
    Vec6 scaled_step = step;
    scaled_step.head<3>() *= translation;
    scaled_step.tail<3>() *= rotation;
    out.steps_.push_back(scaled_step);
    out.poses_.push_back(out.poses_.back() * SE3::exp(scaled_step));
  }
  return out;
}

}  // namespace rf::calibration
