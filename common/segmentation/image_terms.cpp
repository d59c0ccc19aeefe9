// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/image_terms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

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

constexpr int kBlock = 64;  // pixels of a row at a time
using Block = std::array<float, kBlock>;

/// Where B's pixels fall in A.
struct Places {
  alignas(32) Block x, y, z;          ///< the point in A, metres
  alignas(32) Block inverse_z, u, v;  ///< 1/m, px
  alignas(32) std::array<std::int32_t, kBlock> inside;
};

/// What A shows there, channel by channel, and which of it is usable.
struct Looks {
  alignas(32) Block intensity, depth, intensity_u, intensity_v, depth_u, depth_v;
  alignas(32) std::array<std::int32_t, kBlock> usable;
};

/// Derivatives of a residual by the place in A, px and metres, and its weight.
struct Gradient {
  const Block& u;
  const Block& v;
  const Block& weight;
  float sign;  ///< of u and v in the residual
  float z;     ///< by the point's depth
};

/// Residuals and their rows, one body, a row of pixels at a time: in blocks, each step a loop for
/// the vectoriser but for the look-up, which has its channels for lanes.
class Warp {
 public:
  Warp(const TermLevel& level_a, const TermLevel& level_b, const SE3& T_AB,
       const ImageTermParams& params);

  void row(int v, bool rows, BodyTerms& out) const;

 private:
  void project(int v, int begin, int n, Places& at) const;
  void lookUp(int n, const Places& at, Looks& seen) const;
  void residuals(int v, int begin, int n, const Places& at, Looks& seen, bool rows,
                 BodyTerms& out) const;
  void derivatives(int v, int begin, int n, const Places& at, const Gradient& gradient,
                   std::vector<float>* row) const;

  const TermLevel& a_;
  const TermLevel& b_;
  std::array<float, 9> rotation_;  // row-major
  std::array<float, 3> translation_;
  float fx_, fy_, cx_, cy_;      // A
  float bfx_, bfy_, bcx_, bcy_;  // B
  float slant_, gate_, share_, sigma_i_, sigma_base_, sigma_quadratic_;
};

Warp::Warp(const TermLevel& level_a, const TermLevel& level_b, const SE3& T_AB,
           const ImageTermParams& params)
    : a_(level_a),
      b_(level_b),
      fx_(static_cast<float>(a_.camera.fx)),
      fy_(static_cast<float>(a_.camera.fy)),
      cx_(static_cast<float>(a_.camera.cx)),
      cy_(static_cast<float>(a_.camera.cy)),
      bfx_(static_cast<float>(b_.camera.fx)),
      bfy_(static_cast<float>(b_.camera.fy)),
      bcx_(static_cast<float>(b_.camera.cx)),
      bcy_(static_cast<float>(b_.camera.cy)),
      slant_(static_cast<float>(params.max_slant_tan) * 2.0F / fx_),
      gate_(-static_cast<float>(params.occlusion_gate_m)),
      share_(static_cast<float>(params.gradient_share)),
      sigma_i_(static_cast<float>(params.intensity_sigma)),
      sigma_base_(static_cast<float>(params.depth_sigma_base_m)),
      sigma_quadratic_(static_cast<float>(params.depth_sigma_quadratic)) {
  const Mat3 R = T_AB.R();
  for (int k = 0; k < 9; ++k) rotation_[k] = static_cast<float>(R(k / 3, k % 3));
  for (int k = 0; k < 3; ++k) translation_[k] = static_cast<float>(T_AB.t[k]);
}

void Warp::project(int v, int begin, int n, Places& at) const {
  const float* depth = b_.depth.row(v) + begin;
  const float ray_y = (static_cast<float>(v) - bcy_) / bfy_;
  const float u_max = static_cast<float>(a_.depth.width() - 1);
  const float v_max = static_cast<float>(a_.depth.height() - 1);
  const auto [r00, r01, r02, r10, r11, r12, r20, r21, r22] = rotation_;
  const auto [tx, ty, tz] = translation_;
  const float fx = fx_, fy = fy_, cx = cx_, cy = cy_, bcx = bcx_, bfx = bfx_;
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float z_b = depth[i];
    const float x_b = (static_cast<float>(begin + i) - bcx) / bfx * z_b;
    const float y_b = ray_y * z_b;
    const float x = r00 * x_b + (r01 * y_b + r02 * z_b) + tx;
    const float y = r10 * x_b + (r11 * y_b + r12 * z_b) + ty;
    const float z = r20 * x_b + (r21 * y_b + r22 * z_b) + tz;
    const bool before = (z_b > 0.0F) & (z > 0.1F);
    const float inverse_z = 1.0F / (before ? z : 1.0F);
    const float u = fx * x * inverse_z + cx;
    const float w = fy * y * inverse_z + cy;
    at.x[i] = x;
    at.y[i] = y;
    at.z[i] = z;
    at.inverse_z[i] = inverse_z;
    at.u[i] = u;
    at.v[i] = w;
    at.inside[i] = (before & (u >= 0.0F) & (w >= 0.0F) & (u < u_max) & (w < v_max)) ? 1 : 0;
  }
}

void Warp::lookUp(int n, const Places& at, Looks& seen) const {
  for (int i = 0; i < n; ++i) {
    Texel value = Texel::Zero();
    seen.usable[i] = 0;
    if (at.inside[i] != 0) {
      const int u = static_cast<int>(at.u[i]);
      const int v = static_cast<int>(at.v[i]);
      const Texel* top = a_.row(v) + u;
      const Texel* bottom = a_.row(v + 1) + u;
      const float nearest = std::min(std::min(top[0][kDepth], top[1][kDepth]),
                                     std::min(bottom[0][kDepth], bottom[1][kDepth]));
      const float farthest = std::max(std::max(top[0][kDepth], top[1][kDepth]),
                                      std::max(bottom[0][kDepth], bottom[1][kDepth]));
      if (nearest > 0 && farthest - nearest <= std::max(0.03F, slant_ * farthest)) {
        const float fu = at.u[i] - static_cast<float>(u);
        const float fv = at.v[i] - static_cast<float>(v);
        const Texel above = top[0] + fu * (top[1] - top[0]);
        const Texel below = bottom[0] + fu * (bottom[1] - bottom[0]);
        value = above + fv * (below - above);
        seen.usable[i] = value[kDepth] - at.z[i] < gate_ ? 0 : 1;
      }
    }
    seen.intensity[i] = value[kIntensity];
    seen.depth[i] = value[kDepth];
    seen.intensity_u[i] = value[kIntensityU];
    seen.intensity_v[i] = value[kIntensityV];
    seen.depth_u[i] = value[kDepthU];
    seen.depth_v[i] = value[kDepthV];
  }
}

/// Leaves the mean gradients of both frames (second-order accurate for small motions) in `seen`.
void Warp::residuals(int v, int begin, int n, const Places& at, Looks& seen, bool rows,
                     BodyTerms& out) const {
  const std::size_t first = static_cast<std::size_t>(v) * b_.depth.width() + begin;
  const float* depth = b_.depth.row(v) + begin;
  const float* intensity = b_.intensity.row(v) + begin;
  const float* intensity_u = b_.intensity_u.row(v) + begin;
  const float* intensity_v = b_.intensity_v.row(v) + begin;
  const float* depth_u = b_.depth_u.row(v) + begin;
  const float* depth_v = b_.depth_v.row(v) + begin;
  unsigned char* valid = out.valid.data() + first;
  float* r_intensity = out.r_intensity.data() + first;
  float* r_depth = out.r_depth.data() + first;
  const float share = share_, noise2 = sigma_i_ * sigma_i_;
  const float base = sigma_base_, quadratic = sigma_quadratic_;
  alignas(32) Block weight_i, weight_d;
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float iu = 0.5F * (seen.intensity_u[i] + intensity_u[i]);
    const float iv = 0.5F * (seen.intensity_v[i] + intensity_v[i]);
    const float du = 0.5F * (seen.depth_u[i] + depth_u[i]);
    const float dv = 0.5F * (seen.depth_v[i] + depth_v[i]);
    const float dz = depth[i] - 0.4F;
    const float sigma_d = base + quadratic * dz * dz;
    const float w_i = 1.0F / std::sqrt(noise2 + share * (iu * iu + iv * iv));
    const float w_d = 1.0F / std::sqrt(2.0F * sigma_d * sigma_d + share * (du * du + dv * dv));
    r_intensity[i] = w_i * (intensity[i] - seen.intensity[i]);
    r_depth[i] = w_d * (seen.depth[i] - at.z[i]);
    valid[i] = static_cast<unsigned char>(seen.usable[i]);
    seen.intensity_u[i] = iu;
    seen.intensity_v[i] = iv;
    seen.depth_u[i] = du;
    seen.depth_v[i] = dv;
    weight_i[i] = w_i;
    weight_d[i] = w_d;
  }
  if (!rows) return;
  derivatives(v, begin, n, at, {seen.intensity_u, seen.intensity_v, weight_i, -1.0F, 0.0F},
              out.row_intensity);
  derivatives(v, begin, n, at, {seen.depth_u, seen.depth_v, weight_d, 1.0F, -1.0F}, out.row_depth);
}

/// d(projection)/d(p_A), then p_A <- p_A + R (dv + dw x p_B).
void Warp::derivatives(int v, int begin, int n, const Places& at, const Gradient& gradient,
                       std::vector<float>* row) const {
  const std::size_t first = static_cast<std::size_t>(v) * b_.depth.width() + begin;
  const float* depth = b_.depth.row(v) + begin;
  const float ray_y = (static_cast<float>(v) - bcy_) / bfy_;
  const auto [r00, r01, r02, r10, r11, r12, r20, r21, r22] = rotation_;
  const float fx = fx_, fy = fy_, bcx = bcx_, bfx = bfx_;
  const float sign = gradient.sign, along_z = gradient.z;
  float* out0 = row[0].data() + first;
  float* out1 = row[1].data() + first;
  float* out2 = row[2].data() + first;
  float* out3 = row[3].data() + first;
  float* out4 = row[4].data() + first;
  float* out5 = row[5].data() + first;
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float z_b = depth[i];
    const float x_b = (static_cast<float>(begin + i) - bcx) / bfx * z_b;
    const float y_b = ray_y * z_b;
    const float gx = sign * gradient.u[i] * (fx * at.inverse_z[i]);
    const float gy = sign * gradient.v[i] * (fy * at.inverse_z[i]);
    const float g = along_z - (gx * at.x[i] + gy * at.y[i]) * at.inverse_z[i];
    const float w = gradient.weight[i];
    const float ax = w * (r00 * gx + (r10 * gy + r20 * g));
    const float ay = w * (r01 * gx + (r11 * gy + r21 * g));
    const float az = w * (r02 * gx + (r12 * gy + r22 * g));
    out0[i] = ax;
    out1[i] = ay;
    out2[i] = az;
    out3[i] = y_b * az - z_b * ay;
    out4[i] = z_b * ax - x_b * az;
    out5[i] = x_b * ay - y_b * ax;
  }
}

void Warp::row(int v, bool rows, BodyTerms& out) const {
  Places at;
  Looks seen;
  for (int begin = 0; begin < b_.depth.width(); begin += kBlock) {
    const int n = std::min(kBlock, b_.depth.width() - begin);
    project(v, begin, n, at);
    lookUp(n, at, seen);
    residuals(v, begin, n, at, seen, rows, out);
  }
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
  const int height = b.depth.height();
  out.resize(b.depth.size());
  const Warp warp(a, b, T_AB, params);
  const int chunks = (height + kTermRows - 1) / kTermRows;
  parallelChunks(chunks, [&](int chunk) {
    const int end = std::min(height, (chunk + 1) * kTermRows);
    for (int v = chunk * kTermRows; v < end; ++v) warp.row(v, rows, out);
  });
}

}  // namespace rf
