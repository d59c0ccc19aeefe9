// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/se3.hpp"

namespace rf {

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

/// Covariance (right perturbation, translation first) of the increment `d` over `seconds`.
Mat6 incrementCovariance(const DriftModel& model, const SE3& d, double seconds);

}  // namespace rf
