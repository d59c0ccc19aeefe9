// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/paper_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "geometry/parallel.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

constexpr int kPaperRows = 16;  // fixed: the split must not depend on the thread count
constexpr float kIntensityEps = 1e-6F, kDepthEps = 0.005F;  // A.4

int chunkCount(int height) { return (height + kPaperRows - 1) / kPaperRows; }

template <typename Body>
void forRowsOf(int height, int chunk, const Body& body) {
  const int end = std::min(height, (chunk + 1) * kPaperRows);
  for (int v = chunk * kPaperRows; v < end; ++v) body(v);
}

std::vector<float> raysX(const Camera& c) {
  std::vector<float> rays(static_cast<std::size_t>(c.width));
  for (int u = 0; u < c.width; ++u) rays[u] = static_cast<float>((u - c.cx) / c.fx);
  return rays;
}
float rayY(const Camera& c, int v) { return static_cast<float>((v - c.cy) / c.fy); }

void reshape(Image<float>& image, int width, int height) {
  if (image.width() != width || image.height() != height) image = Image<float>(width, height);
}

/// The side with the smaller jump dominates (A.4).
inline float edgeGradient(float minus, float centre, float plus, float eps) {
  const float f = plus - centre, b = centre - minus;
  const float rf_ = std::abs(f) + eps, rb = std::abs(b) + eps;
  return (rb * f + rf_ * b) / (rf_ + rb);
}

/// Backward look-up of A at B's pixels.
class Warp {
 public:
  Warp(const RgbdLevel& a, const RgbdLevel& b, const SE3& T_AB, const PaperConfig& config)
      : a_(a),
        b_(b),
        R_AB_(T_AB.R().cast<float>()),
        t_(T_AB.t.cast<float>()),
        fx_(static_cast<float>(a.camera.fx)),
        fy_(static_cast<float>(a.camera.fy)),
        cx_(static_cast<float>(a.camera.cx)),
        cy_(static_cast<float>(a.camera.cy)),
        spread_(static_cast<float>(config.depth_spread_m)),
        gate_(static_cast<float>(config.occlusion_gate_m)) {}

  /// True when the pixel has a pair; intensity of A there, and A's depth brought into B.
  bool operator()(float ray_x, float ray_y, float z_b, float& intensity, float& depth) const {
    const Eigen::Vector3f p = R_AB_ * Eigen::Vector3f(ray_x * z_b, ray_y * z_b, z_b) + t_;
    if (!(z_b > 0) || !(p.z() > 0.1F)) return false;
    const float iz = 1.0F / p.z();
    const float ua = fx_ * p.x() * iz + cx_, va = fy_ * p.y() * iz + cy_;
    const int width = a_.depth.width(), height = a_.depth.height();
    if (!(ua >= 0 && va >= 0 && ua < static_cast<float>(width - 1) &&
          va < static_cast<float>(height - 1))) {
      return false;
    }
    const int u0 = static_cast<int>(ua), v0 = static_cast<int>(va);
    const float fu = ua - static_cast<float>(u0), fv = va - static_cast<float>(v0);
    const float *d0 = a_.depth.row(v0) + u0, *d1 = a_.depth.row(v0 + 1) + u0;
    const float nearest = std::min(std::min(d0[0], d0[1]), std::min(d1[0], d1[1]));
    const float farthest = std::max(std::max(d0[0], d0[1]), std::max(d1[0], d1[1]));
    if (!(nearest > 0) || farthest - nearest > spread_) return false;
    const float difference = mix(d0, d1, fu, fv) - p.z();
    if (difference < -gate_) return false;
    const float *i0 = a_.intensity.row(v0) + u0, *i1 = a_.intensity.row(v0 + 1) + u0;
    intensity = mix(i0, i1, fu, fv);
    depth = z_b + difference;
    return depth > 0;
  }

 private:
  static float mix(const float* top, const float* low, float fu, float fv) {
    const float t = top[0] + fu * (top[1] - top[0]);
    const float l = low[0] + fu * (low[1] - low[0]);
    return t + fv * (l - t);
  }
  const RgbdLevel& a_;
  const RgbdLevel& b_;
  Eigen::Matrix3f R_AB_;
  Eigen::Vector3f t_;
  float fx_, fy_, cx_, cy_, spread_, gate_;
};

struct Largest {
  float i = 0, d = 0;
  Largest& operator+=(const Largest& o) {
    i = std::max(i, o.i);
    d = std::max(d, o.d);
    return *this;
  }
};

/// Rows of one image line from the averaged images.
void lineariseRow(const RgbdLevel& b, int v, PaperRows& out, Largest& largest) {
  const int width = b.camera.width;
  const auto fx = static_cast<float>(b.camera.fx), fy = static_cast<float>(b.camera.fy);
  const float *im = out.intensity_mean.row(v), *dm = out.depth_mean.row(v);
  const float *iu = out.intensity_mean.row(v - 1), *id = out.intensity_mean.row(v + 1);
  const float *du = out.depth_mean.row(v - 1), *dd = out.depth_mean.row(v + 1);
  const float *ib = b.intensity.row(v), *db = b.depth.row(v);
  float *z = out.z.row(v), *i_r = out.i_r.row(v), *i_a = out.i_a.row(v), *i_b = out.i_b.row(v);
  float *d_r = out.d_r.row(v), *d_a = out.d_a.row(v), *d_b = out.d_b.row(v);
  float *i_w = out.i_w.row(v), *d_w = out.d_w.row(v);
  float largest_i = 0, largest_d = 0;
#pragma GCC ivdep
  for (int u = 1; u < width - 1; ++u) {
    const float zz = dm[u] > 0 ? dm[u] : 1.0F;
    const float valid = dm[u] > 0 ? 1.0F : 0.0F;
    const float iz = 1.0F / zz;
    // mean = (B + A)/2, so B - A = 2 (B - mean).
    const float it = 2.0F * (ib[u] - im[u]), dt = 2.0F * (db[u] - dm[u]);
    const float gu = edgeGradient(im[u - 1], im[u], im[u + 1], kIntensityEps);
    const float gv = edgeGradient(iu[u], im[u], id[u], kIntensityEps);
    const float hu = edgeGradient(dm[u - 1], dm[u], dm[u + 1], kDepthEps);
    const float hv = edgeGradient(du[u], dm[u], dd[u], kDepthEps);
    const float wi = valid / std::sqrt(1.0F + 10.0F * (std::abs(it) + std::abs(gu) + std::abs(gv)));
    const float wd =
        valid / std::sqrt(0.01F + 200.0F * (std::abs(dt) + std::abs(hu) + std::abs(hv)));
    z[u] = valid * zz;
    i_w[u] = wi;
    i_r[u] = wi * it;
    i_a[u] = wi * gu * fx * iz;
    i_b[u] = wi * gv * fy * iz;
    d_w[u] = wd;
    d_r[u] = wd * dt;
    d_a[u] = wd * hu * fx * iz;
    d_b[u] = wd * hv * fy * iz;
  }
  for (int u = 1; u < width - 1; ++u) {
    largest_i = std::max(largest_i, i_w[u]);
    largest_d = std::max(largest_d, d_w[u]);
  }
  largest += Largest{largest_i, largest_d};
}

/// Flow factors of a pixel (see PaperRows), prepared per image line.
struct Flow {
  float d0, d1, d2, d3, d4, d5, y;
  Flow(const Vec6& d, float ray_y)
      : d0(static_cast<float>(d(0))),
        d1(static_cast<float>(d(1))),
        d2(static_cast<float>(d(2))),
        d3(static_cast<float>(d(3))),
        d4(static_cast<float>(d(4))),
        d5(static_cast<float>(d(5))),
        y(ray_y) {}
  float a(float x, float z) const {
    return -d0 + x * d2 + z * (x * y * d3 - (x * x + 1.0F) * d4 + y * d5);
  }
  float b(float x, float z) const {
    return -d1 + y * d2 + z * ((y * y + 1.0F) * d3 - x * y * d4 - x * d5);
  }
  float z(float x, float zz) const { return d2 + zz * (y * d3 - x * d4); }
};

using Lanes = float __attribute__((vector_size(32)));
constexpr int kLanes = 8;

Lanes load(const float* p) {
  Lanes out;
  std::memcpy(&out, p, sizeof(out));
  return out;
}
double total(const Lanes& l) {
  return static_cast<double>(((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7])));
}

/// One image line of both residual kinds: intensity in the first half, depth in the second. Padded
/// with zero weights to whole lanes. Explicit lanes make the order of additions part of the
/// program.
class RowBuffer {
 public:
  explicit RowBuffer(int width)
      : half_((width + kLanes - 1) / kLanes * kLanes),
        data_(static_cast<std::size_t>(half_) * 20) {}
  int half() const { return half_; }
  float* row(int k) { return data_.data() + static_cast<std::ptrdiff_t>(2 * half_) * k; }
  float* weight() { return row(6); }    // g w
  float* residual() { return row(7); }  // r0 (at delta = 0)
  float* current() { return row(8); }   // r at delta
  float* gamma() { return row(9); }     // g, first half only

  void addTo(NormalSums& sums) {
    addProducts<0>(sums);
    addProducts<1>(sums);
    addProducts<2>(sums);
    addProducts<3>(sums);
    addProducts<4>(sums);
    addProducts<5>(sums);
    Lanes weight_sum{}, squares{}, support{};
    for (int p = 0; p < 2 * half_; p += kLanes) {
      const Lanes w = load(weight() + p), r = load(current() + p);
      weight_sum += w;
      squares += w * r * r;
    }
    for (int p = 0; p < half_; p += kLanes) support += load(gamma() + p);
    sums.weight += total(weight_sum);
    sums.squares += total(squares);
    sums.support += total(support);
  }

 private:
  template <int I>
  void addProducts(NormalSums& sums) {
    Lanes acc[7 - I] = {};
    for (int p = 0; p < 2 * half_; p += kLanes) {
      const Lanes w = load(weight() + p) * load(row(I) + p);
      for (int k = I; k < 6; ++k) acc[k - I] += w * load(row(k) + p);
      acc[6 - I] += w * load(residual() + p);
    }
    for (int k = I; k < 6; ++k) sums.H(I, k) += total(acc[k - I]);
    sums.b(I) -= total(acc[6 - I]);
  }
  int half_;
  std::vector<float> data_;
};

void fillRow(const PaperRows& rows, const std::uint8_t* label, const LabelWeights& weights,
             const std::vector<float>& rays, const Flow& flow, float inv_c2, int v,
             RowBuffer& buffer) {
  const int width = rows.camera.width, half = buffer.half();
  const float *z = rows.z.row(v), *i_r = rows.i_r.row(v), *i_a = rows.i_a.row(v);
  const float *i_b = rows.i_b.row(v), *d_r = rows.d_r.row(v), *d_a = rows.d_a.row(v);
  const float *d_b = rows.d_b.row(v), *d_w = rows.d_w.row(v), *ray = rays.data();
  const float si = rows.scale_i, sd = rows.scale_d, y = flow.y;
  float* j[6];
  for (int k = 0; k < 6; ++k) j[k] = buffer.row(k);
  float *w = buffer.weight(), *r0 = buffer.residual(), *r = buffer.current(), *g = buffer.gamma();
  for (int u = 0; u < width; ++u) g[u] = z[u] > 0 ? weights[label[u]] : 0.0F;
#pragma GCC ivdep
  for (int u = 0; u < width; ++u) {
    const float a = si * i_a[u], b = si * i_b[u], x = ray[u], zz = z[u];
    j[0][u] = -a;
    j[1][u] = -b;
    j[2][u] = a * x + b * y;
    j[3][u] = zz * (a * x * y + b * (y * y + 1.0F));
    j[4][u] = -zz * (a * (x * x + 1.0F) + b * x * y);
    j[5][u] = zz * (a * y - b * x);
    const float ri = si * i_r[u];
    const float now = ri + a * flow.a(x, zz) + b * flow.b(x, zz);
    r0[u] = ri;
    r[u] = now;
    w[u] = g[u] / (1.0F + now * now * inv_c2);
  }
#pragma GCC ivdep
  for (int u = 0; u < width; ++u) {
    const float a = sd * d_a[u], b = sd * d_b[u], c = sd * d_w[u], x = ray[u], zz = z[u];
    const int o = half + u;
    j[0][o] = -a;
    j[1][o] = -b;
    j[2][o] = c + a * x + b * y;
    j[3][o] = zz * (c * y + a * x * y + b * (y * y + 1.0F));
    j[4][o] = -zz * (c * x + a * (x * x + 1.0F) + b * x * y);
    j[5][o] = zz * (a * y - b * x);
    const float rd = sd * d_r[u];
    const float now = rd + a * flow.a(x, zz) + b * flow.b(x, zz) + c * flow.z(x, zz);
    r0[o] = rd;
    r[o] = now;
    w[o] = g[u] / (1.0F + now * now * inv_c2);
  }
}

/// Natural logarithm of x >= 1, relative error below 1e-6; branch-free, so that loops vectorise,
/// and the same bits on every machine (std::log is not).
inline float fastLog(float x) {
  std::int32_t bits;
  std::memcpy(&bits, &x, sizeof(bits));
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;  // mantissa in [sqrt 1/2, sqrt 2)
  bits -= exponent << 23;
  float m;
  std::memcpy(&m, &bits, sizeof(m));
  const float s = (m - 1.0F) / (m + 1.0F), s2 = s * s;
  const float series =
      2.0F * s * (1.0F + s2 * (1.0F / 3 + s2 * (1.0F / 5 + s2 * (1.0F / 7 + s2 * (1.0F / 9)))));
  return series + 0.69314718F * static_cast<float>(exponent);
}

/// Residuals of one image line at delta: log energy, |r_I| + |r_D|, unweighted |r_D|.
void residualRow(const PaperRows& rows, const std::vector<float>& rays, const Flow& flow, float c,
                 int v, float* log_energy, float* absolute, float* depth) {
  const float *z = rows.z.row(v), *i_r = rows.i_r.row(v), *i_a = rows.i_a.row(v);
  const float *i_b = rows.i_b.row(v), *d_r = rows.d_r.row(v), *d_a = rows.d_a.row(v);
  const float *d_b = rows.d_b.row(v), *d_w = rows.d_w.row(v), *ray = rays.data();
  const float si = rows.scale_i, sd = rows.scale_d, inv_c2 = 1.0F / (c * c);
#pragma GCC ivdep
  for (int u = 0; u < rows.camera.width; ++u) {
    const float x = ray[u], zz = z[u];
    const float fa = flow.a(x, zz), fb = flow.b(x, zz), fz = flow.z(x, zz);
    const float ri = si * (i_r[u] + i_a[u] * fa + i_b[u] * fb);
    const float raw = d_r[u] + d_a[u] * fa + d_b[u] * fb + d_w[u] * fz;
    const float rd = sd * raw;
    log_energy[u] = fastLog((1.0F + ri * ri * inv_c2) * (1.0F + rd * rd * inv_c2));
    absolute[u] = std::abs(ri) + std::abs(rd);
    depth[u] = std::abs(raw) / (d_w[u] > 0 ? d_w[u] : 1.0F);
  }
}

}  // namespace

Vec6 PaperRows::intensityRow(int u, int v) const {
  const double a = static_cast<double>(scale_i * i_a(u, v));
  const double b = static_cast<double>(scale_i * i_b(u, v));
  const double x = (u - camera.cx) / camera.fx, y = (v - camera.cy) / camera.fy;
  const double depth = static_cast<double>(z(u, v));
  Vec6 row;
  row << -a, -b, a * x + b * y, depth * (a * x * y + b * (y * y + 1)),
      -depth * (a * (x * x + 1) + b * x * y), depth * (a * y - b * x);
  return row;
}

Vec6 PaperRows::depthRow(int u, int v) const {
  const double a = static_cast<double>(scale_d * d_a(u, v));
  const double b = static_cast<double>(scale_d * d_b(u, v));
  const double w = static_cast<double>(scale_d * d_w(u, v));
  const double x = (u - camera.cx) / camera.fx, y = (v - camera.cy) / camera.fy;
  const double depth = static_cast<double>(z(u, v));
  Vec6 row;
  row << -a, -b, w + a * x + b * y, depth * (w * y + a * x * y + b * (y * y + 1)),
      -depth * (w * x + a * (x * x + 1) + b * x * y), depth * (a * y - b * x);
  return row;
}

void linearisePair(const RgbdLevel& a, const RgbdLevel& b, const SE3& T_AB,
                   const PaperConfig& config, PaperRows& out) {
  const int width = b.camera.width, height = b.camera.height;
  out.camera = b.camera;
  out.scale_i = out.scale_d = 1;
  for (Image<float>* plane : {&out.z, &out.i_r, &out.i_a, &out.i_b, &out.d_r, &out.d_a, &out.d_b,
                              &out.i_w, &out.d_w, &out.intensity_mean, &out.depth_mean}) {
    reshape(*plane, width, height);  // border rows are never written and stay 0
  }
  const Warp warp(a, b, T_AB, config);
  const std::vector<float> rays = raysX(b.camera);
  parallelChunks(chunkCount(height), [&](int chunk) {
    forRowsOf(height, chunk, [&](int v) {
      const float ray_y = rayY(b.camera, v);
      for (int u = 0; u < width; ++u) {
        float intensity = 0, depth = 0;
        const float z_b = b.depth(u, v), i_b = b.intensity(u, v);
        const bool pair = warp(rays[u], ray_y, z_b, intensity, depth);
        out.intensity_mean(u, v) = pair ? 0.5F * (i_b + intensity) : i_b;
        out.depth_mean(u, v) = pair ? 0.5F * (z_b + depth) : 0.0F;
      }
    });
  });
  const Largest largest =
      reduceChunks(chunkCount(height), Largest{}, [&](int chunk, Largest& part) {
        forRowsOf(height, chunk, [&](int v) {
          if (v > 0 && v < height - 1) lineariseRow(b, v, out, part);
        });
      });
  out.largest_i = largest.i;
  out.largest_d = largest.d;
}

void normalise(const PaperConfig& config, PaperRows& first, PaperRows* second) {
  const float i = std::max(first.largest_i, second != nullptr ? second->largest_i : 0.0F);
  const float d = std::max(first.largest_d, second != nullptr ? second->largest_d : 0.0F);
  for (PaperRows* rows : {&first, second}) {
    if (rows == nullptr) continue;
    rows->scale_i = i > 0 ? static_cast<float>(config.intensity_weight) / i : 1.0F;
    rows->scale_d = d > 0 ? 1.0F / d : 1.0F;
  }
}

NormalSums& NormalSums::operator+=(const NormalSums& o) {
  H += o.H;
  b += o.b;
  weight += o.weight;
  squares += o.squares;
  support += o.support;
  return *this;
}

NormalSums accumulate(const PaperRows& rows, const Image<std::uint8_t>& label,
                      const LabelWeights& weights, const Vec6& delta, float c) {
  const int height = rows.camera.height;
  const std::vector<float> rays = raysX(rows.camera);
  NormalSums sums =
      reduceChunks(chunkCount(height), NormalSums{}, [&](int chunk, NormalSums& part) {
        RowBuffer buffer(rows.camera.width);
        forRowsOf(height, chunk, [&](int v) {
          const Flow flow(delta, rayY(rows.camera, v));
          fillRow(rows, label.row(v), weights, rays, flow, 1.0F / (c * c), v, buffer);
          buffer.addTo(part);
        });
      });
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < i; ++k) sums.H(i, k) = sums.H(k, i);
  }
  return sums;
}

ClusterResiduals::ClusterResiduals(std::size_t n)
    : log_s(n), log_d(n), abs_s(n), abs_d(n), depth_s(n), pixels(n) {}

ClusterResiduals& ClusterResiduals::operator+=(const ClusterResiduals& o) {
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    log_s[k] += o.log_s[k];
    log_d[k] += o.log_d[k];
    abs_s[k] += o.abs_s[k];
    abs_d[k] += o.abs_d[k];
    depth_s[k] += o.depth_s[k];
    pixels[k] += o.pixels[k];
  }
  return *this;
}

ClusterResiduals evaluateClusters(const PaperRows& s, const Vec6& delta_s, const PaperRows* d,
                                  const Vec6& delta_d, const Image<std::uint8_t>& label,
                                  std::size_t clusters, float c) {
  const int width = s.camera.width, height = s.camera.height;
  const std::vector<float> rays = raysX(s.camera);
  const auto body = [&](int chunk, ClusterResiduals& part) {
    std::vector<float> buffer(static_cast<std::size_t>(width) * 6, 0.0F);
    float* plane[6];
    for (int k = 0; k < 6; ++k) plane[k] = buffer.data() + static_cast<std::ptrdiff_t>(width) * k;
    forRowsOf(height, chunk, [&](int v) {
      const float y = rayY(s.camera, v);
      residualRow(s, rays, Flow(delta_s, y), c, v, plane[0], plane[1], plane[2]);
      if (d != nullptr) {
        residualRow(*d, rays, Flow(delta_d, y), c, v, plane[3], plane[4], plane[5]);
      }
      for (int u = 0; u < width; ++u) {
        const std::uint8_t k = label(u, v);
        if (k >= clusters || !(s.z(u, v) > 0) || (d != nullptr && !(d->z(u, v) > 0))) continue;
        part.log_s[k] += static_cast<double>(plane[0][u]);
        part.abs_s[k] += static_cast<double>(plane[1][u]);
        part.depth_s[k] += static_cast<double>(plane[2][u]);
        part.log_d[k] += static_cast<double>(plane[3][u]);
        part.abs_d[k] += static_cast<double>(plane[4][u]);
        part.pixels[k] += 1;
      }
    });
  };
  return reduceChunks(chunkCount(height), ClusterResiduals(clusters), body);
}

BodyFit judgeFit(const PaperRows& rows, const Image<std::uint8_t>& label,
                 const LabelWeights& weights) {
  // Sensor model of an Xtion-class camera: depth noise grows with z^2; an intensity may be off by
  // half a pixel of its gradient. Cauchy scale 2.4 sigma, its 95 % efficient choice.
  constexpr double kCauchy = 2.4;
  constexpr int kStride = 2;  // a quarter of the pixels tells as much
  double inliers = 0, squares = 0;
  for (int v = 0; v < rows.camera.height; v += kStride) {
    for (int u = 0; u < rows.camera.width; u += kStride) {
      const double g = static_cast<double>(weights[label(u, v)]);
      const double z = static_cast<double>(rows.z(u, v));
      if (!(g > 0) || !(z > 0)) continue;
      const double wi = static_cast<double>(rows.i_w(u, v)),
                   wd = static_cast<double>(rows.d_w(u, v));
      const auto variance = [&](double base, float a, float b, double w) {
        const double gu = static_cast<double>(a) / w * z / rows.camera.fx;
        const double gv = static_cast<double>(b) / w * z / rows.camera.fy;
        return base + 0.25 * (gu * gu + gv * gv);
      };
      const double sigma_z = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
      const double ri = static_cast<double>(rows.i_r(u, v)) / wi;
      const double rd = static_cast<double>(rows.d_r(u, v)) / wd;
      const double chi2 =
          0.5 * (ri * ri / variance(2 * 0.02 * 0.02, rows.i_a(u, v), rows.i_b(u, v), wi) +
                 rd * rd / variance(2 * sigma_z * sigma_z, rows.d_a(u, v), rows.d_b(u, v), wd));
      const double w = g / (1 + chi2 / (kCauchy * kCauchy));
      inliers += w;
      squares += w * chi2;
    }
  }
  return {kStride * kStride * inliers, inliers > 0 ? std::sqrt(squares / inliers) : 0};
}

}  // namespace rf
