// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/pyramid.hpp"
#include "geometry/se3.hpp"

namespace rf {

/// Noise model and gates of the image residuals (docs/ALGORITHM.md, "Image terms").
struct ImageTermParams {
  double intensity_sigma = 0.02;          ///< of one grey value, 0..1
  double depth_sigma_base_m = 0.0012;     ///< depth sigma at 0.4 m
  double depth_sigma_quadratic = 0.0019;  ///< 1/m: sigma_z = base + quadratic (z - 0.4)^2
  double gradient_share = 0.25;    ///< squared pixels of registration error charged per gradient
  double occlusion_gate_m = 0.15;  ///< A's surface this far in front of the point hides it
  double max_slant_tan = 3.7;      ///< steepest surface trusted (75 degrees); steeper: depth edge

  template <class V>
  void visit(V& v) {
    v("intensity_sigma", intensity_sigma, 1e-4, 1.0, "-", "noise of one grey value, white = 1");
    v("depth_sigma_base_m", depth_sigma_base_m, 1e-5, 0.1, "m", "depth noise at 0.4 m");
    v("depth_sigma_quadratic", depth_sigma_quadratic, 0.0, 0.1, "1/m",
      "its growth with (z - 0.4 m)^2");
    v("gradient_share", gradient_share, 0.0, 10.0, "px^2",
      "registration error charged through the gradients");
    v("occlusion_gate_m", occlusion_gate_m, 0.01, 2.0, "m",
      "a reference surface this far in front hides a point");
    v("max_slant_tan", max_slant_tan, 0.5, 50.0, "-", "tangent of the steepest surface trusted");
  }
};

/// One pyramid level of a frame with the gradients that the residuals need (per pixel of that
/// level).
struct TermLevel {
  Camera camera;
  Image<float> intensity;                 ///< 0..1
  Image<float> depth;                     ///< metres, 0 invalid
  Image<float> intensity_u, intensity_v;  ///< 1 / px
  Image<float> depth_u, depth_v;          ///< m / px, edge-preserving (algorithm A.4)

  /// The same side by side, as linearise() reads the pixels of A: intensity, depth, intensity_u,
  /// intensity_v, depth_u, depth_v, and two that mean nothing. A bilinear look-up in all of them is
  /// one in vectors. The planes are for the pixels of B, a row of which is a vector each.
  using Texel = Eigen::Array<float, 8, 1>;
  std::vector<Texel> texels;
  const Texel* row(int v) const {
    return texels.data() + static_cast<std::ptrdiff_t>(v) * depth.width();
  }
};

/// Edge-preserving gradients on both planes; 0 at the border and beside missing depth.
TermLevel makeTermLevel(const RgbdLevel& level);

/// Whitened residuals and their rows for one body on B's pixel grid (struct of arrays, pixel index
/// v * width + u). Rows are derivatives by a right perturbation of T_AB, translation first.
struct BodyTerms {
  std::vector<unsigned char> valid;  ///< 1 where both residuals exist
  std::vector<float> r_intensity, r_depth;
  std::vector<float> row_intensity[6], row_depth[6];
  void resize(std::size_t pixels);
};

/// Paper Eq. for r_I and r_D, evaluated on B's grid with a backward look-up (paper section III
/// frames):
///   r_I = I_B(x) - I_A(W(x, T_AB)),  r_D = D_A(W(x, T_AB)) - |T_AB pi^-1(x, D_B)|_z,
/// each divided by its sigma. A pixel is invalid when a depth is missing, the point leaves A, lands
/// on a depth edge of A, or is hidden by a surface of A more than the gate in front. With `rows`
/// false only residuals are made. Deterministic for any thread count.
void linearise(const TermLevel& a, const TermLevel& b, const SE3& T_AB,
               const ImageTermParams& params, bool rows, BodyTerms& out);

}  // namespace rf
