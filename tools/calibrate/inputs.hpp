// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/calibrate.hpp"

namespace rf {

/// What a user names on the command line.
struct CalibrateOptions {
  calibration::Problem problem = calibration::Problem::kOdometry;
  std::string robot;              ///< robot folder instead of the next
  std::string moving;             ///< poses of base, gripper or hand: TUM trajectory
  std::string seen;               ///< poses of camera or object: TUM trajectory, or a result folder
  std::string camera;             ///< camera poses that turn object poses T_WO into T_CO
  bool same_frame = false;        ///< grasp: gripper poses are T_CG in the camera's frame
  std::string config;             ///< YAML with prior.base_to_camera
  std::vector<double> extrinsic;  ///< x y z qx qy qz qw; empty: none
  std::vector<std::string> estimate;  ///< groups; empty: all that the problem has
  double sigma_translation = 0.05;    ///< m
  double sigma_rotation_deg = 5;
  double largest_offset = 0.3;  ///< s
  std::string output;
};

/// Trajectories and prior as the library wants them.
struct CalibrateInput {
  calibration::CalibrationRequest request;
  Trajectory A, X;
  std::vector<std::string> notes;
};

/// Reads what the options name. Throws std::invalid_argument for options that do not fit together,
/// DatasetError or ConfigError for files that cannot be used.
CalibrateInput readInput(const CalibrateOptions& options);

}  // namespace rf
