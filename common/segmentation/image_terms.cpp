// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/image_terms.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

constexpr int kTermRows = 15;           // fixed: the split must not depend on the thread count
constexpr float kIntensityEps = 1e-6F;  // algorithm A.4
constexpr float kDepthEps = 0.005F;     // metres, algorithm A.4

/// The side with the smaller jump dominates (algorithm A.4).
float edgePreservingGradient(float minus, float centre, float plus, float eps) {
  const float forward = plus - centre;
  const float backward = centre - minus;
  const float rf_weight = std::abs(forward) + eps;
  const float rb_weight = std::abs(backward) + eps;
  return (rb_weight * forward + rf_weight * backward) / (rf_weight + rb_weight);
}

/// A missing neighbour says nothing: the gradient is then the other side's, or 0.
float depthGradient(float minus, float centre, float plus) {
  if (centre <= 0) return 0;
  if (minus > 0 && plus > 0) return edgePreservingGradient(minus, centre, plus, kDepthEps);
  if (plus > 0) return plus - centre;
  if (minus > 0) return centre - minus;
  return 0;
}

using Texel = TermLevel::Texel;
enum Channel { kIntensity, kDepth, kIntensityU, kIntensityV, kDepthU, kDepthV };

/// Everything of one linearisation that does not change from pixel to pixel.
struct Warp {
  const TermLevel& a;
  const TermLevel& b;
  const ImageTermParams& params;
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
  float fx, fy, cx, cy;      // A
  float bfx, bfy, bcx, bcy;  // B

  Warp(const TermLevel& level_a, const TermLevel& level_b, const SE3& T_AB,
       const ImageTermParams& p)
      : a(level_a),
        b(level_b),
        params(p),
        R(T_AB.R().cast<float>()),
        t(T_AB.t.cast<float>()),
        fx(static_cast<float>(a.camera.fx)),
        fy(static_cast<float>(a.camera.fy)),
        cx(static_cast<float>(a.camera.cx)),
        cy(static_cast<float>(a.camera.cy)),
        bfx(static_cast<float>(b.camera.fx)),
        bfy(static_cast<float>(b.camera.fy)),
        bcx(static_cast<float>(b.camera.cx)),
        bcy(static_cast<float>(b.camera.cy)) {}

  bool pixel(int u, int v, bool rows, std::size_t i, BodyTerms& out) const;
};

bool Warp::pixel(int u, int v, bool rows, std::size_t i, BodyTerms& out) const {
  const Texel& at_b = b.row(v)[u];
  const float z_b = at_b[kDepth];
  if (!(z_b > 0)) return false;
  const Eigen::Vector3f p_b((static_cast<float>(u) - bcx) / bfx * z_b,
                            (static_cast<float>(v) - bcy) / bfy * z_b, z_b);
  const Eigen::Vector3f p = R * p_b + t;
  if (!(p.z() > 0.1F)) return false;
  const float iz = 1.0F / p.z();
  const float ua = fx * p.x() * iz + cx;
  const float va = fy * p.y() * iz + cy;
  const int width = a.depth.width();
  const int height = a.depth.height();
  if (!(ua >= 0 && va >= 0 && ua < static_cast<float>(width - 1) &&
        va < static_cast<float>(height - 1))) {
    return false;
  }
  const int u0 = static_cast<int>(ua);
  const int v0 = static_cast<int>(va);
  const float fu = ua - static_cast<float>(u0);
  const float fv = va - static_cast<float>(v0);
  const Texel* top = a.row(v0) + u0;
  const Texel* bottom = a.row(v0 + 1) + u0;
  const float nearest = std::min(std::min(top[0][kDepth], top[1][kDepth]),
                                 std::min(bottom[0][kDepth], bottom[1][kDepth]));
  const float farthest = std::max(std::max(top[0][kDepth], top[1][kDepth]),
                                  std::max(bottom[0][kDepth], bottom[1][kDepth]));
  if (!(nearest > 0)) return false;
  const float slant = static_cast<float>(params.max_slant_tan) * 2.0F * farthest / fx;
  if (farthest - nearest > std::max(0.03F, slant)) return false;
  const Texel above = top[0] + fu * (top[1] - top[0]);
  const Texel below = bottom[0] + fu * (bottom[1] - bottom[0]);
  const Texel at_a = above + fv * (below - above);
  const float r_d = at_a[kDepth] - p.z();
  if (r_d < -static_cast<float>(params.occlusion_gate_m)) return false;
  const float r_i = at_b[kIntensity] - at_a[kIntensity];

  // Gradients: mean of both frames' (second-order accurate for small motions).
  const Texel mean = 0.5F * (at_a + at_b);
  const float iu = mean[kIntensityU];
  const float iv = mean[kIntensityV];
  const float du = mean[kDepthU];
  const float dv = mean[kDepthV];
  const auto share = static_cast<float>(params.gradient_share);
  const auto sigma_i = static_cast<float>(params.intensity_sigma);
  const float dz = z_b - 0.4F;
  const float sigma_d = static_cast<float>(params.depth_sigma_base_m) +
                        static_cast<float>(params.depth_sigma_quadratic) * dz * dz;
  const float w_i = 1.0F / std::sqrt(sigma_i * sigma_i + share * (iu * iu + iv * iv));
  const float w_d = 1.0F / std::sqrt(2.0F * sigma_d * sigma_d + share * (du * du + dv * dv));
  out.r_intensity[i] = w_i * r_i;
  out.r_depth[i] = w_d * r_d;
  if (!rows) return true;

  // d(projection)/d(p_A), then p_A <- p_A + R (dv + dw x p_B).
  const float px = fx * iz;
  const float py = fy * iz;
  const auto gradientToRow = [&](float gu, float gv, float gz, float weight,
                                 std::vector<float>* row) {
    const Eigen::Vector3f g(gu * px, gv * py, gz - (gu * px * p.x() + gv * py * p.y()) * iz);
    const Eigen::Vector3f av = weight * (R.transpose() * g);
    const Eigen::Vector3f aw = p_b.cross(av);
    for (int k = 0; k < 3; ++k) {
      row[k][i] = av[k];
      row[k + 3][i] = aw[k];
    }
  };
  gradientToRow(-iu, -iv, 0.0F, w_i, out.row_intensity);
  gradientToRow(du, dv, -1.0F, w_d, out.row_depth);
  return true;
}

}  // namespace

TermLevel makeTermLevel(const RgbdLevel& level) {
  const int width = level.depth.width();
  const int height = level.depth.height();
  TermLevel out{level.camera,
                level.intensity,
                level.depth,
                Image<float>(width, height),
                Image<float>(width, height),
                Image<float>(width, height),
                Image<float>(width, height),
                std::vector<Texel>(level.depth.size())};
  const int chunks = (height + kTermRows - 1) / kTermRows;
  parallelChunks(chunks, [&](int chunk) {
    const int end = std::min(height, (chunk + 1) * kTermRows);
    for (int v = chunk * kTermRows; v < end; ++v) {
      const bool inner = v > 0 && v < height - 1;
      for (int u = 1; inner && u < width - 1; ++u) {
        const float i = level.intensity(u, v);
        out.intensity_u(u, v) = edgePreservingGradient(level.intensity(u - 1, v), i,
                                                       level.intensity(u + 1, v), kIntensityEps);
        out.intensity_v(u, v) = edgePreservingGradient(level.intensity(u, v - 1), i,
                                                       level.intensity(u, v + 1), kIntensityEps);
        const float d = level.depth(u, v);
        out.depth_u(u, v) = depthGradient(level.depth(u - 1, v), d, level.depth(u + 1, v));
        out.depth_v(u, v) = depthGradient(level.depth(u, v - 1), d, level.depth(u, v + 1));
      }
      Texel* texels = out.texels.data() + static_cast<std::ptrdiff_t>(v) * width;
      for (int u = 0; u < width; ++u) {
        texels[u] << out.intensity(u, v), out.depth(u, v), out.intensity_u(u, v),
            out.intensity_v(u, v), out.depth_u(u, v), out.depth_v(u, v), 0.0F, 0.0F;
      }
    }
  });
  return out;
}

void BodyTerms::resize(std::size_t pixels) {
  valid.resize(pixels);
  r_intensity.resize(pixels);
  r_depth.resize(pixels);
  for (int k = 0; k < 6; ++k) {
    row_intensity[k].resize(pixels);
    row_depth[k].resize(pixels);
  }
}

void linearise(const TermLevel& a, const TermLevel& b, const SE3& T_AB,
               const ImageTermParams& params, bool rows, BodyTerms& out) {
  const int width = b.depth.width();
  const int height = b.depth.height();
  out.resize(b.depth.size());
  const Warp warp(a, b, T_AB, params);
  const int chunks = (height + kTermRows - 1) / kTermRows;
  parallelChunks(chunks, [&](int chunk) {
    const int end = std::min(height, (chunk + 1) * kTermRows);
    for (int v = chunk * kTermRows; v < end; ++v) {
      for (int u = 0; u < width; ++u) {
        const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(u);
        out.valid[i] = warp.pixel(u, v, rows, i, out) ? 1 : 0;
      }
    }
  });
}

}  // namespace rf
