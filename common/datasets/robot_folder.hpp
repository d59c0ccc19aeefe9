// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "priors/robot_prior.hpp"

namespace rf {

/// Lays `folder`/robot.yaml, when it exists, over `config.robot`. Throws ConfigError.
void loadRobotConfig(const std::string& folder, PriorConfig& config);

/// The robot of a folder without samples: robot.urdf (or what the configuration calls it, relative
/// to the folder). Throws DatasetError when the file cannot be read, KinematicsError when it or the
/// configuration's links cannot be used.
RobotPrior openRobot(const std::string& folder, const PriorConfig& config);

/// The same with the recorded samples: odometry.txt (T_WB) or twist.csv, joints.csv, grasp.csv,
/// each only where it exists. What the files hold that the robot has to refuse or flag (jumps)
/// comes back in `remarks`, at most a few lines of each kind. Throws DatasetError on a malformed
/// file, and when there are both odometry.txt and twist.csv.
struct RobotRecording {
  RobotPrior robot;
  std::vector<std::string> remarks;
};
RobotRecording readRobot(const std::string& folder, const PriorConfig& config);

}  // namespace rf
