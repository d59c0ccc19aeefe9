// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "calibration/calibrate.hpp"

namespace rf {

/// What a robot folder (robot.yaml, robot.urdf, odometry.txt or twist.csv, joints.csv, grasp.csv)
/// holds for a calibration.
struct RobotInput {
  Trajectory moving;             ///< raw stamps: T_WB, T_CG or T_BG
  std::optional<SE3> extrinsic;  ///< what the URDF says: T_BC or T_GC
  /// Times (us, A's clock) between which the object is held; only for a grasp, empty: no grasp.csv.
  std::vector<std::pair<std::int64_t, std::int64_t>> held;
};

/// Reads the part for the problem. For odometry no joint between base and camera may move; from
/// twists (m/s, rad/s) the base starts at the origin of its world. Throws DatasetError, ConfigError
/// or KinematicsError, naming file and rule: an unreadable file or number, odometry.txt beside
/// twist.csv, a joint that is missing or moves, a grasp.csv in which nothing is held.
RobotInput readRobotInput(const std::string& folder, calibration::Problem problem);

}  // namespace rf
