// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace rf {

enum class RobustKernel { kHuber, kTukey, kCauchy };

/// Weight (0..1) of a whitened residual x, kernel width in the usual 95 % efficiency constants.
float robustWeight(RobustKernel kernel, float x);

/// Points of the model as one pyramid level of the prediction shows them, in the frame P of the
/// camera that the prediction was drawn for; one array per attribute.
struct ReferencePoints {
  std::vector<float> x, y, z;     ///< metres
  std::vector<float> nx, ny, nz;  ///< unit normal
  std::vector<float> intensity;   ///< 0..1
  std::vector<float> weight;      ///< 0..1, trust in the model there

  std::size_t size() const { return x.size(); }
};

/// One evaluation of all rows at a pose.
struct KernelInput {
  std::array<float, 9> R_CP{};  ///< row-major: reference frame P -> current camera C
  std::array<float, 3> t_CP{};
  float fx = 0, fy = 0, cx = 0, cy = 0;
  int width = 0, height = 0;
  const float* depth = nullptr;      ///< current image, metres, 0 = none
  const float* intensity = nullptr;  ///< current image, 0..1
  const float* weight = nullptr;     ///< of the current pixel: share of this body, 0..1
  float sigma_base = 0, sigma_growth = 0, sigma_near = 0;  ///< depth noise
  float sigma_floor = 0;                                   ///< metres, along the normal
  float sigma_intensity = 0, gradient_intensity = 0;
  float distance = 0;     ///< largest depth difference of a pair
  float grazing_cos = 0;  ///< least cosine between ray and normal
  float scale_depth = 1;  ///< robust scale of whitened residuals, from the iteration before
  float scale_intensity = 1;
  float gain = 1, offset = 0;  ///< brightness of the current image: I_C = gain I_P + offset
  float use_depth = 1, use_intensity = 1;
  RobustKernel kernel = RobustKernel::kCauchy;
};

/// Sums over the rows. Rows are J (1x6, right perturbation of T_PC, translation first) and residual
/// r, divided by sigma: H = sum w J'J, b = -sum w J' r.
struct KernelSums {
  std::array<double, 21> H{};  ///< upper triangle, row by row
  std::array<double, 6> b{};
  double cost = 0;   ///< sum of w r^2 (whitened)
  double pairs = 0;  ///< sum of weights of pairs with depth in view, not hidden by something nearer
  double in_view = 0;                      ///< ... hidden ones too
  double inliers = 0;                      ///< ... of pairs within 3 robust sigma
  double inlier_r2 = 0;                    ///< their weighted whitened squared depth residuals
  double inlier_m2 = 0;                    ///< ... in square metres
  double weight_depth = 0, abs_depth = 0;  ///< for the next robust scale
  double weight_intensity = 0, abs_intensity = 0;
  double sw = 0, sp = 0, sc = 0, spp = 0, spc = 0,
         scc = 0;  ///< for brightness: sums of w, I_P, I_C, ...

  KernelSums& operator+=(const KernelSums& o);
};

/// Adds the rows of points [begin, end) of the reference to the sums (paper section V;
/// point-to-plane residual n.(T q - p) and photometric residual I_C(pi(T^-1 p)) - gain I_P -
/// offset). Current depth is looked up at the nearest pixel, intensity bilinearly with the exact
/// gradient of the interpolant.
void accumulateRows(const ReferencePoints& reference, std::size_t begin, std::size_t end,
                    const KernelInput& input, KernelSums& sums);

}  // namespace rf
