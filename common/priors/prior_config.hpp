// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/se3.hpp"
#include "priors/drift_model.hpp"
#include "priors/robot_config.hpp"

namespace rf {

/// A fixed transform in a configuration.
struct TransformConfig {
  double x = 0, y = 0, z = 0;
  double qx = 0, qy = 0, qz = 0, qw = 1;

  template <class V>
  void visit(V& v) {
    v("x", x, -100.0, 100.0, "m", "translation");
    v("y", y, -100.0, 100.0, "m", "translation");
    v("z", z, -100.0, 100.0, "m", "translation");
    v("qx", qx, -1.0, 1.0, "-", "unit quaternion, Hamilton; note the order x y z w");
    v("qy", qy, -1.0, 1.0, "-", "unit quaternion");
    v("qz", qz, -1.0, 1.0, "-", "unit quaternion");
    v("qw", qw, -1.0, 1.0, "-", "unit quaternion, real part");
  }
};

/// Parameters of the motion priors (paper section III; drift defaults from its experiments).
struct PriorConfig {
  DriftModel camera;
  DriftModel object{0.015, 0.1, 0.0, 0.0};
  TransformConfig base_to_camera;
  std::string object_frame = "world";
  double max_gap = 0.2;
  double max_extrapolation = 0.1;
  RobotConfig robot;

  template <class V>
  void visit(V& v) {
    v("camera", camera, "drift of the camera's pose source");
    v("object", object, "drift of the object's pose source");
    v("base_to_camera", base_to_camera,
      "T_BC: the camera in the body that the camera's pose source reports");
    v("object_frame", object_frame, "-",
      "world: object poses are T_WO in a world of their own | camera: they are T_CO (kinematics)");
    v("max_gap", max_gap, 1e-3, 60.0, "s", "longest gap between poses that is interpolated over");
    v("max_extrapolation", max_extrapolation, 0.0, 60.0, "s",
      "longest time beyond the poses at hand that is bridged with constant velocity");
    v("robot", robot, "priors from odometry, joints and grasps of a robot (docs/ROBOT.md)");
  }
};

/// The transform with its quaternion normalised. Throws std::invalid_argument, naming `field`, when
/// the quaternion is further than 1e-3 from unit length or a number is not finite.
SE3 toTransform(const TransformConfig& config, const std::string& field);

}  // namespace rf
