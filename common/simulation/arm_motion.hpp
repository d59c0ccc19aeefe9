// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "kinematics/robot_model.hpp"

namespace rf::sim {

/// Joints that bring `tip` to T_BT (in `base`), by damped Gauss-Newton steps from `start`: those
/// between the two links move, the others keep the start's values. Joint limits are not looked at.
/// Throws std::invalid_argument naming the rest when it does not come within 0.01 mm and 0.01 mrad.
JointPositions solveInverse(const RobotModel& model, const std::string& base,
                            const std::string& tip, const SE3& T_BT, const JointPositions& start);

/// Joint positions over time: smooth curves (Catmull-Rom) through samples at a fixed rate, constant
/// outside. Const members are thread-safe.
class JointTrack {
 public:
  /// Samples at 0, 1 / rate, ... seconds, all of the same joints.
  JointTrack(double rate, std::vector<JointPositions> samples);
  JointPositions at(double t) const;

 private:
  double rate_;
  std::vector<JointPositions> samples_;
};

}  // namespace rf::sim
