// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/se3.hpp"

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

/// How fast a pose source drifts: the covariance of an increment d over dt is diagonal in the frame
/// of the source's body, with standard deviations
///   translation  hypot(sigma_v dt, sigma_v_per_m |t_d|),   rotation  hypot(sigma_w dt, ... |w_d|)
/// on each axis.
struct DriftModel {
  double sigma_v = 0.06;
  double sigma_w = 0.4;
  double sigma_v_per_m = 0.0;
  double sigma_w_per_rad = 0.0;

  template <class V>
  void visit(V& v) {
    v("sigma_v", sigma_v, 1e-6, 100.0, "m/s", "translation drift per second, each axis");
    v("sigma_w", sigma_w, 1e-6, 100.0, "rad/s", "rotation drift per second, each axis");
    v("sigma_v_per_m", sigma_v_per_m, 0.0, 10.0, "-", "translation drift per metre travelled");
    v("sigma_w_per_rad", sigma_w_per_rad, 0.0, 10.0, "-", "rotation drift per radian turned");
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
  }
};

/// The transform with its quaternion normalised. Throws std::invalid_argument, naming `field`, when
/// the quaternion is further than 1e-3 from unit length or a number is not finite.
SE3 toTransform(const TransformConfig& config, const std::string& field);

/// Covariance (right perturbation, translation first) of the increment `d` over `seconds`.
Mat6 incrementCovariance(const DriftModel& model, const SE3& d, double seconds);

}  // namespace rf
