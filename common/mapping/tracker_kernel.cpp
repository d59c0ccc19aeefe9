// SPDX-License-Identifier: BSD-3-Clause
// Compiled with reassociation (see CMakeLists.txt), so that the loops below vectorise. No NaN may
// come in: depth 0 means none, and every mask is a comparison that is false for it.
#include "mapping/tracker_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace rf {
namespace {

constexpr std::size_t kBatch = 256;
using Row = std::array<float, kBatch>;

// Rows of a batch: stage one fills them, stage two takes dot products.
struct Rows {
  alignas(64) std::array<Row, 6> jd, ji;  // whitened Jacobians
  alignas(64) Row rd, wd, ri, wi;         // whitened residuals and weights
  alignas(64) Row pair, seen, inlier, m2, ad, ai, ip, ic, base_d, base_i;
};

constexpr float kHuberWidth = 1.345F, kTukeyWidth = 4.685F, kCauchyWidth = 2.385F;

template <RobustKernel kKernel>
inline float robust(float x) {
  const float a = std::abs(x);
  if constexpr (kKernel == RobustKernel::kHuber) return a <= kHuberWidth ? 1.0F : kHuberWidth / a;
  if constexpr (kKernel == RobustKernel::kTukey) {
    const float y = 1.0F - x * x * (1.0F / (kTukeyWidth * kTukeyWidth));
    return y > 0.0F ? y * y : 0.0F;
  }
  return 1.0F / (1.0F + x * x * (1.0F / (kCauchyWidth * kCauchyWidth)));
}

template <RobustKernel kKernel>
void fillRows(const ReferencePoints& p, std::size_t begin, std::size_t n, const KernelInput& in,
              Rows& r) {
  const float r00 = in.R_CP[0], r01 = in.R_CP[1], r02 = in.R_CP[2], r10 = in.R_CP[3],
              r11 = in.R_CP[4], r12 = in.R_CP[5], r20 = in.R_CP[6], r21 = in.R_CP[7],
              r22 = in.R_CP[8];
  const float tx = in.t_CP[0], ty = in.t_CP[1], tz = in.t_CP[2];
  const float ifx = 1.0F / in.fx, ify = 1.0F / in.fy;
  const auto umax = static_cast<float>(in.width - 2), vmax = static_cast<float>(in.height - 2);
  const float* px = p.x.data() + begin;
  const float* py = p.y.data() + begin;
  const float* pz = p.z.data() + begin;
  const float* pnx = p.nx.data() + begin;
  const float* pny = p.ny.data() + begin;
  const float* pnz = p.nz.data() + begin;
  const float* pi = p.intensity.data() + begin;
  const float* pw = p.weight.data() + begin;
  const float inv_scale_d = 1.0F / in.scale_depth, inv_scale_i = 1.0F / in.scale_intensity;
  const float grazing2 = in.grazing_cos * in.grazing_cos;
  const float* depth = in.depth;
  const float* intensity = in.intensity;
  const float* weight = in.weight;
  const int width = in.width;
  // Copies, so that the compiler sees that no store changes them.
  const float fx = in.fx, fy = in.fy, cx = in.cx, cy = in.cy;
  const float distance = in.distance, gain = in.gain, offset = in.offset;
  const float sigma_near = in.sigma_near, sigma_base = in.sigma_base,
              sigma_growth = in.sigma_growth;
  const float floor2 = in.sigma_floor * in.sigma_floor;
  const float noise2 = in.sigma_intensity * in.sigma_intensity;
  const float gradient2 = in.gradient_intensity * in.gradient_intensity;
  const float use_depth = in.use_depth, use_intensity = in.use_intensity;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const float x = r00 * px[i] + r01 * py[i] + r02 * pz[i] + tx;
    const float y = r10 * px[i] + r11 * py[i] + r12 * pz[i] + ty;
    const float z = r20 * px[i] + r21 * py[i] + r22 * pz[i] + tz;
    const float mx = r00 * pnx[i] + r01 * pny[i] + r02 * pnz[i];
    const float my = r10 * pnx[i] + r11 * pny[i] + r12 * pnz[i];
    const float mz = r20 * pnx[i] + r21 * pny[i] + r22 * pnz[i];
    const float safe_z = z > 0.05F ? z : 1.0F;
    const float iz = 1.0F / safe_z;
    const float u = fx * x * iz + cx;
    const float v = fy * y * iz + cy;
    const bool inside = (z > 0.05F) & (u >= 0.5F) & (v >= 0.5F) & (u <= umax) & (v <= vmax);
    const float su = inside ? u : 1.0F;
    const float sv = inside ? v : 1.0F;
    // Nearest pixel: depth and body share.
    const int iu = static_cast<int>(su + 0.5F);
    const int iv = static_cast<int>(sv + 0.5F);
    const int nearest = iv * width + iu;
    const float d = depth[nearest];
    const float share = weight[nearest] * pw[i];
    const float w0 = (inside & (d > 0.0F)) ? share : 0.0F;
    // Point to plane: current point q on the pixel's ray against the model's plane, in C.
    const float rx = (static_cast<float>(iu) - cx) * ifx;
    const float ry = (static_cast<float>(iv) - cy) * ify;
    const float qx = rx * d, qy = ry * d;
    const float cosine = mx * rx + my * ry + mz;  // n . ray
    const bool steep = cosine * cosine > grazing2 * (rx * rx + ry * ry + 1.0F);
    const bool close = std::abs(d - z) < distance;
    const float dn = std::max(d - sigma_near, 0.0F);
    const float sigma_z = sigma_base + sigma_growth * dn * dn;
    const float sd = std::sqrt(cosine * cosine * sigma_z * sigma_z + floor2);
    const float isd = 1.0F / sd;
    const float residual = mx * (qx - x) + my * (qy - y) + mz * (d - z);
    const float white = residual * isd;
    const float base_d = (close & steep) ? w0 : 0.0F;
    r.rd[i] = white;
    r.base_d[i] = base_d;
    r.wd[i] = use_depth * base_d * robust<kKernel>(white * inv_scale_d);
    r.ad[i] = std::abs(white);
    // What hides the model does not contradict it.
    r.pair[i] = d - z > -distance ? w0 : 0.0F;
    r.seen[i] = w0;
    r.inlier[i] = std::abs(white * inv_scale_d) < 3.0F ? base_d : 0.0F;
    r.m2[i] = residual * residual;
    r.jd[0][i] = mx * isd;
    r.jd[1][i] = my * isd;
    r.jd[2][i] = mz * isd;
    r.jd[3][i] = (qy * mz - d * my) * isd;
    r.jd[4][i] = (d * mx - qx * mz) * isd;
    r.jd[5][i] = (qx * my - qy * mx) * isd;
    // Photometric: bilinear look-up and its exact derivative.
    const int fu = static_cast<int>(su);
    const int fv = static_cast<int>(sv);
    const float a = su - static_cast<float>(fu), b = sv - static_cast<float>(fv);
    const int at = fv * width + fu;
    const float i00 = intensity[at], i10 = intensity[at + 1];
    const float i01 = intensity[at + width], i11 = intensity[at + width + 1];
    const float top = i00 + a * (i10 - i00), bottom = i01 + a * (i11 - i01);
    const float ic = top + b * (bottom - top);
    const float gu = (i10 - i00) + b * ((i11 - i01) - (i10 - i00));
    const float gv = bottom - top;
    const float si2 = noise2 + gradient2 * (gu * gu + gv * gv);
    const float isi = 1.0F / std::sqrt(si2);
    const float ri = (ic - gain * pi[i] - offset) * isi;
    r.ri[i] = ri;
    r.base_i[i] = base_d;
    r.wi[i] = use_intensity * base_d * robust<kKernel>(ri * inv_scale_i);
    r.ai[i] = std::abs(ri);
    r.ip[i] = pi[i];
    r.ic[i] = ic;
    const float ax = gu * fx * iz * isi, ay = gv * fy * iz * isi;
    const float az = -(ax * x + ay * y) * iz;
    r.ji[0][i] = -ax;
    r.ji[1][i] = -ay;
    r.ji[2][i] = -az;
    r.ji[3][i] = -(y * az - safe_z * ay);
    r.ji[4][i] = -(safe_z * ax - x * az);
    r.ji[5][i] = -(x * ay - y * ax);
  }
}

inline double dot(const Row& a, const Row& b, std::size_t n) {
  float sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return static_cast<double>(sum);
}

inline double dot3(const Row& a, const Row& b, const Row& c, std::size_t n) {
  float sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i] * c[i];
  return static_cast<double>(sum);
}

inline double total(const Row& a, std::size_t n) {
  float sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i];
  return static_cast<double>(sum);
}

void addProducts(const std::array<Row, 6>& j, const Row& residual, const Row& weight, std::size_t n,
                 KernelSums& s) {
  alignas(64) Row wj;
  std::size_t out = 0;
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t i = 0; i < n; ++i) wj[i] = weight[i] * j[row][i];
    for (std::size_t col = row; col < 6; ++col) s.H[out++] += dot(wj, j[col], n);
    s.b[row] -= dot(wj, residual, n);
  }
  s.cost += dot3(weight, residual, residual, n);
}

void addStatistics(const Rows& r, std::size_t n, KernelSums& s) {
  s.pairs += total(r.pair, n);
  s.in_view += total(r.seen, n);
  s.inliers += total(r.inlier, n);
  s.inlier_r2 += dot3(r.inlier, r.rd, r.rd, n);
  s.inlier_m2 += dot(r.inlier, r.m2, n);
  s.weight_depth += total(r.base_d, n);
  s.abs_depth += dot(r.base_d, r.ad, n);
  s.weight_intensity += total(r.base_i, n);
  s.abs_intensity += dot(r.base_i, r.ai, n);
  s.sw += total(r.wi, n);
  s.sp += dot(r.wi, r.ip, n);
  s.sc += dot(r.wi, r.ic, n);
  s.spp += dot3(r.wi, r.ip, r.ip, n);
  s.spc += dot3(r.wi, r.ip, r.ic, n);
  s.scc += dot3(r.wi, r.ic, r.ic, n);
}

}  // namespace

float robustWeight(RobustKernel kernel, float x) {
  switch (kernel) {
    case RobustKernel::kHuber:
      return robust<RobustKernel::kHuber>(x);
    case RobustKernel::kTukey:
      return robust<RobustKernel::kTukey>(x);
    case RobustKernel::kCauchy:
      break;
  }
  return robust<RobustKernel::kCauchy>(x);
}

KernelSums& KernelSums::operator+=(const KernelSums& o) {
  for (std::size_t i = 0; i < H.size(); ++i) H[i] += o.H[i];
  for (std::size_t i = 0; i < b.size(); ++i) b[i] += o.b[i];
  cost += o.cost;
  pairs += o.pairs;
  in_view += o.in_view;
  inliers += o.inliers;
  inlier_r2 += o.inlier_r2;
  inlier_m2 += o.inlier_m2;
  weight_depth += o.weight_depth;
  abs_depth += o.abs_depth;
  weight_intensity += o.weight_intensity;
  abs_intensity += o.abs_intensity;
  sw += o.sw;
  sp += o.sp;
  sc += o.sc;
  spp += o.spp;
  spc += o.spc;
  scc += o.scc;
  return *this;
}

void accumulateRows(const ReferencePoints& reference, std::size_t begin, std::size_t end,
                    const KernelInput& input, KernelSums& sums) {
  Rows rows;
  for (std::size_t at = begin; at < end; at += kBatch) {
    const std::size_t n = std::min(kBatch, end - at);
    switch (input.kernel) {
      case RobustKernel::kHuber:
        fillRows<RobustKernel::kHuber>(reference, at, n, input, rows);
        break;
      case RobustKernel::kTukey:
        fillRows<RobustKernel::kTukey>(reference, at, n, input, rows);
        break;
      case RobustKernel::kCauchy:
        fillRows<RobustKernel::kCauchy>(reference, at, n, input, rows);
        break;
    }
    if (input.use_depth > 0) addProducts(rows.jd, rows.rd, rows.wd, n, sums);
    if (input.use_intensity > 0) addProducts(rows.ji, rows.ri, rows.wi, n, sums);
    addStatistics(rows, n, sums);
  }
}

}  // namespace rf
