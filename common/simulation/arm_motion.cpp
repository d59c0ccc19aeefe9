// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/arm_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Dense>

namespace rf::sim {
namespace {

constexpr int kIterations = 200;
constexpr double kDamping = 1e-4;
constexpr double kLargest = 0.2;   // rad or m in one step
constexpr double kReached = 1e-5;  // m and rad

}  // namespace

JointPositions solveInverse(const RobotModel& model, const std::string& base,
                            const std::string& tip, const SE3& T_BT, const JointPositions& start) {
  JointPositions q = start;
  Vec6 rest = Vec6::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    rest = (model.T_AB(base, tip, q).inverse() * T_BT).log();
    if (rest.cwiseAbs().maxCoeff() < kReached) return q;
    const RobotJacobian motion = model.jacobian(base, tip, q);
    const Mat6 H = motion.J * motion.J.transpose() + kDamping * Mat6::Identity();
    Eigen::VectorXd step = motion.J.transpose() * H.ldlt().solve(rest);
    step *= std::min(1.0, kLargest / std::max(step.cwiseAbs().maxCoeff(), 1e-12));
    for (std::size_t k = 0; k < motion.joints.size(); ++k) {
      q[motion.joints[k]] += step[static_cast<Eigen::Index>(k)];
    }
  }
  throw std::invalid_argument(fmt::format(
      "the arm does not reach {:.3f} {:.3f} {:.3f}: {:.4f} m and {:.4f} rad are left", T_BT.t.x(),
      T_BT.t.y(), T_BT.t.z(), rest.head<3>().norm(), rest.tail<3>().norm()));
}

JointTrack::JointTrack(double rate, std::vector<JointPositions> samples)
    : rate_(rate), samples_(std::move(samples)) {
  if (samples_.empty() || !(rate > 0)) throw std::invalid_argument("JointTrack: no samples");
}

JointPositions JointTrack::at(double t) const {
  const auto last = static_cast<std::ptrdiff_t>(samples_.size()) - 1;
  const double place = std::clamp(t * rate_, 0.0, static_cast<double>(last));
  const auto i = static_cast<std::ptrdiff_t>(place);
  const double u = place - static_cast<double>(i);
  const auto sample = [&](std::ptrdiff_t k) -> const JointPositions& {
    return samples_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  JointPositions out = sample(i);
  for (auto& [name, value] : out) {
    const double a = sample(i - 1).at(name);
    const double b = sample(i).at(name);
    const double c = sample(i + 1).at(name);
    const double d = sample(i + 2).at(name);
    value = b + 0.5 * (u * (c - a) + u * u * (2 * a - 5 * b + 4 * c - d) +
                       u * u * u * (3 * b - a - 3 * c + d));
  }
  return out;
}

}  // namespace rf::sim
