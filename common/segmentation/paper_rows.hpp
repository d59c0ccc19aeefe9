// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/image.hpp"
#include "geometry/pyramid.hpp"
#include "geometry/se3.hpp"
#include "segmentation/paper_config.hpp"

namespace rf {

/// Weight per label byte; the entry of kNoCluster is 0.
using LabelWeights = std::array<float, 256>;

/// Linearised residuals of one body on B's grid (algorithm A.4-A.6 after a backward look-up, B.2).
/// For a right update T_AB <- T_AB exp(d) a pixel of valid depth z has the residuals
///   r_I = scale_i (i_r + i_a fa + i_b fb),   r_D = scale_d (d_r + d_a fa + d_b fb + d_w fz),
/// with, for the ray (x, y, 1) of the pixel, the flow of the static point per unit of d
///   fa = -d0 + x d2 + z (x y d3 - (x^2 + 1) d4 + y d5),
///   fb = -d1 + y d2 + z ((y^2 + 1) d3 - x y d4 - x d5),
///   fz = d2 + z (y d3 - x d4).
struct PaperRows {
  Camera camera;
  Image<float> z;              ///< mean depth of B and warped A, metres; 0 = no pair here
  Image<float> i_r, i_a, i_b;  ///< intensity: w_I (I_B - I_w), w_I I_u fx / z, w_I I_v fy / z
  Image<float> d_r, d_a, d_b;  ///< depth: the same with w_D (metres)
  Image<float> i_w, d_w;       ///< pre-weights before their normalisation
  float scale_i = 1;           ///< alpha_I / largest w_I
  float scale_d = 1;           ///< 1 / largest w_D
  float largest_i = 0;         ///< largest pre-weight in the image
  float largest_d = 0;
  Image<float> intensity_mean, depth_mean;  ///< averages of B and warped A, for the gradients

  /// Row of a pixel's residual by the six components of d, scaled and weighted.
  Vec6 intensityRow(int u, int v) const;
  Vec6 depthRow(int u, int v) const;
};

/// Linearises the pair at T_AB (C_B -> C_A). A pixel has no pair when a depth is missing, the point
/// leaves A, the 2x2 look-up crosses a depth step, A's surface hides it, or it lies on the border.
/// Scales are left at 1; see normalise. Deterministic for every thread count.
void linearisePair(const RgbdLevel& a, const RgbdLevel& b, const SE3& T_AB,
                   const PaperConfig& config, PaperRows& out);

/// Divides the pre-weights by their largest value in the image (A.6), a common one for both bodies
/// so that neither is favoured; `second` may be null.
void normalise(const PaperConfig& config, PaperRows& first, PaperRows* second);

/// Gauss-Newton sums of one body: H = sum g w a a', b = -sum g w a r0, both rows of every pixel,
/// with Cauchy weights w of the residuals at `delta`.
struct NormalSums {
  Mat6 H = Mat6::Zero();
  Vec6 b = Vec6::Zero();
  double weight = 0;   ///< sum g w over rows
  double squares = 0;  ///< sum g w r^2 at delta
  double support = 0;  ///< sum g over pixels
  NormalSums& operator+=(const NormalSums& o);
};
NormalSums accumulate(const PaperRows& rows, const Image<std::uint8_t>& label,
                      const LabelWeights& weights, const Vec6& delta, float c);

/// Per cluster, over the pixels that have a pair for every body given (one or two).
struct ClusterResiduals {
  std::vector<double> log_s, log_d;  ///< sum of ln(1+(r_I/c)^2) + ln(1+(r_D/c)^2)
  std::vector<double> abs_s, abs_d;  ///< sum of |r_I| + |r_D|
  std::vector<double> depth_s;       ///< sum of the unweighted |depth residual| of s, metres
  std::vector<double> pixels;
  ClusterResiduals() = default;
  explicit ClusterResiduals(std::size_t clusters);
  ClusterResiduals& operator+=(const ClusterResiduals& o);
};
ClusterResiduals evaluateClusters(const PaperRows& s, const Vec6& delta_s, const PaperRows* d,
                                  const Vec6& delta_d, const Image<std::uint8_t>& label,
                                  std::size_t clusters, float c);

/// How well one body fits, in the units of the sensor model (1 = as expected): Cauchy-weighted.
struct BodyFit {
  double inliers = 0;  ///< sum g w over pixels
  double rms = 0;
};
BodyFit judgeFit(const PaperRows& rows, const Image<std::uint8_t>& label,
                 const LabelWeights& weights);

}  // namespace rf
