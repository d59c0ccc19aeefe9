// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rf {

/// How the robot's own pixels are told (kinematics/self_filter.hpp).
struct SelfFilterConfig {
  bool enabled = true;
  double margin_m = 0.015;
  double gate_sigma = 3.0;
  double sigma_base_m = 0.0012;
  double sigma_growth = 0.0019;

  template <class V>
  void visit(V& v) {
    v("enabled", enabled, "-", "mask the robot's own links where a prior brings their shapes");
    v("margin_m", margin_m, 0.0, 0.5, "m",
      "by which shapes grow on all sides: for the shapes, the joints and the camera's place");
    v("gate_sigma", gate_sigma, 0.0, 20.0, "sigma", "and, along the ray, by so much depth noise");
    v("sigma_base_m", sigma_base_m, 1e-5, 0.1, "m", "depth noise at 0.4 m");
    v("sigma_growth", sigma_growth, 0.0, 0.1, "1/m",
      "sigma_z = base + growth (z - 0.4)^2, as the sensor's");
  }
};

}  // namespace rf
