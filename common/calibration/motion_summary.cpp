// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/motion_summary.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace rf::calibration {
namespace {

constexpr double kStep = 1.0;  ///< s; long enough for the noise of poses to count little

struct Variation {
  double n = 0, sum = 0, squares = 0;
  void add(double x) {
    n += 1;
    sum += x;
    squares += x * x;
  }
  double deviation() const {
    return n < 2 ? 0 : std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
  }
};

}  // namespace

MotionSummary summarise(const Path& path, double from, double to) {
  MotionSummary out;
  out.duration = std::max(0.0, to - from);
  Variation speed;
  Variation turning;
  Mat3 axes = Mat3::Zero();
  for (double t = from; t + kStep <= to; t += kStep) {
    const Vec6 xi = (path.at(t).inverse() * path.at(t + kStep)).log();
    out.travelled += xi.head<3>().norm();
    out.turned += xi.tail<3>().norm();
    axes += xi.tail<3>() * xi.tail<3>().transpose();
    speed.add(xi.head<3>().norm() / kStep);
    turning.add(xi.tail<3>().norm() / kStep);
  }
  out.speed_variation = speed.deviation();
  out.turn_variation = turning.deviation();
  if (axes.trace() > 0) {
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(axes);
    out.axis_shares = eigen.eigenvalues().reverse() / axes.trace();
  }
  return out;
}

}  // namespace rf::calibration
