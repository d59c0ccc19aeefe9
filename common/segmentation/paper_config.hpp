// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rf {

/// Parameters of the modes that follow the publications: rigidfusion-paper, static, static-prior,
/// vo. Sources and the measured reasons of our choices: docs/ALGORITHM.md, "Paper mode".
struct PaperConfig {
  int clusters = 24;               ///< K
  int levels = 5;                  ///< from the working resolution down
  double lambda_r = 2;             ///< weight of S_R and S_T (paper, section VI)
  double lambda_s = 1;             ///< weight of the static prior when it is on
  double lambda_d = 1;             ///< weight of the dynamic prior when it is on
  double n_hat = 0.01;             ///< prior switched on when the estimate is further away
  double d_hat = 0.01;             ///< priors closer than this: everything is static
  double intensity_weight = 0.15;  ///< alpha_I
  double cauchy_factor = 0.5;      ///< c = factor * weighted mean |r|
  int gamma_power = 1;             ///< of gamma on the squared rows: 1 paper, 2 StaticFusion's code
  int outer_iterations = 3;        ///< re-warps a level
  int inner_iterations = 6;        ///< IRLS iterations a re-warp
  double outer_tolerance = 0.04;   ///< twist norm that ends a level
  double inner_tolerance = 1.5e-3;   ///< largest change that ends IRLS
  double depth_spread_m = 0.1;       ///< 2x2 look-ups over a larger depth step are rejected
  double occlusion_gate_m = 0.15;    ///< A's surface this far in front hides a point
  double outlier_factor = 1.5;       ///< k_b of StaticFusion's rule
  double max_step_m = 0.15;          ///< motions further from their start are rejected
  double max_step_rad = 0.3;         ///< the same for turns
  double least_static_share = 0.05;  ///< below it the state has collapsed: start again

  template <class V>
  void visit(V& v) {
    v("clusters", clusters, 1, 250, "-", "clusters a frame (K)");
    v("levels", levels, 1, 8, "-", "pyramid levels from the working resolution down");
    v("lambda_r", lambda_r, 1e-3, 100.0, "-", "weight of both score regularisers");
    v("lambda_s", lambda_s, 0.0, 1e6, "-", "weight of the static prior when it is on");
    v("lambda_d", lambda_d, 0.0, 1e6, "-", "weight of the dynamic prior when it is on");
    v("n_hat", n_hat, 0.0, 10.0, "m, rad", "distance from a prior that switches it on");
    v("d_hat", d_hat, 0.0, 10.0, "m, rad", "priors closer than this: everything is static");
    v("intensity_weight", intensity_weight, 0.0, 100.0, "-", "weight of intensity rows");
    v("cauchy_factor", cauchy_factor, 0.01, 10.0, "-", "Cauchy scale per mean absolute residual");
    v("gamma_power", gamma_power, 1, 2, "-", "power of the scores on squared residuals");
    v("outer_iterations", outer_iterations, 1, 20, "-", "re-warps a level at most");
    v("inner_iterations", inner_iterations, 1, 50, "-", "IRLS iterations a re-warp at most");
    v("outer_tolerance", outer_tolerance, 1e-7, 1.0, "m, rad", "twist norm that ends a level");
    v("inner_tolerance", inner_tolerance, 1e-7, 1.0, "m, rad", "change that ends IRLS");
    v("depth_spread_m", depth_spread_m, 0.001, 10.0, "m", "depth step that spoils a look-up");
    v("occlusion_gate_m", occlusion_gate_m, 0.01, 100.0, "m",
      "a surface of A this far in front hides a point");
    v("outlier_factor", outlier_factor, 1.0, 10.0, "-",
      "residual over the mean that makes a cluster dynamic (StaticFusion)");
    v("max_step_m", max_step_m, 0.001, 10.0, "m", "motions further from their start are rejected");
    v("max_step_rad", max_step_rad, 0.001, 3.0, "rad", "turns further from their start");
    v("least_static_share", least_static_share, 0.0, 0.5, "-",
      "static share below which the state has collapsed");
  }
};

}  // namespace rf
