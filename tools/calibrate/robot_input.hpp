// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibration/calibrate.hpp"

namespace rf {

/// What a robot folder (robot.yaml, robot.urdf, odometry.txt, joints.csv, grasp.csv) holds for a
/// calibration.
struct RobotInput {
  Trajectory moving;             ///< raw stamps: T_WB, T_CG or T_BG
  std::optional<SE3> extrinsic;  ///< what the URDF says: T_BC or T_GC
  /// Times (A's clock) between which the object is held; only for a grasp.
  std::vector<std::pair<std::int64_t, std::int64_t>> held;
};

/// Reads the part for the problem. For odometry no joint between base and camera may move. Throws
/// DatasetError, ConfigError or KinematicsError, naming file and rule.
RobotInput readRobotInput(const std::string& folder, calibration::Problem problem);

}  // namespace rf
