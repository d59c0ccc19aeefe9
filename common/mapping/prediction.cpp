// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/prediction.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

struct View {
  Eigen::Matrix3f R;  // camera from body
  Eigen::Vector3f t;
  float fx = 0, fy = 0, cx = 0, cy = 0;
  int width = 0, height = 0;
  std::vector<float> ray_x, ray_y;  // viewing ray (x, y, 1) of a column and of a row
};

View makeView(const SE3& T_FC, const Camera& camera) {
  View v;
  const SE3 T_CF = T_FC.inverse();
  v.R = T_CF.R().cast<float>();
  v.t = T_CF.t.cast<float>();
  v.fx = static_cast<float>(camera.fx);
  v.fy = static_cast<float>(camera.fy);
  v.cx = static_cast<float>(camera.cx);
  v.cy = static_cast<float>(camera.cy);
  v.width = camera.width;
  v.height = camera.height;
  for (int u = 0; u < camera.width; ++u)
    v.ray_x.push_back(static_cast<float>((u - camera.cx) / camera.fx));
  v.ray_x.insert(v.ray_x.end(), 4, std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < camera.height; ++y)
    v.ray_y.push_back(static_cast<float>((y - camera.cy) / camera.fy));
  return v;
}

// The discs of a block in the camera: centre, plane q = 1/z = a . ray, box in pixels.
struct Discs {
  template <typename T>
  using Row = std::array<T, kBlockSize>;
  alignas(64) Row<float> x, y, z, ax, ay, az, r2, bias, yield;
  alignas(64) Row<std::int32_t> u0, u1, v0, v1;  // u1 < u0: nothing to draw
};

void projectDiscs(const SurfelBlock& b, const View& view, const PredictOptions& o, Discs& d) {
  const Eigen::Matrix3f& R = view.R;
  const float r00 = R(0, 0), r01 = R(0, 1), r02 = R(0, 2), r10 = R(1, 0), r11 = R(1, 1),
              r12 = R(1, 2), r20 = R(2, 0), r21 = R(2, 1), r22 = R(2, 2);
  const float tx = view.t.x(), ty = view.t.y(), tz = view.t.z();
  const float fx = view.fx, fy = view.fy, cx = view.cx, cy = view.cy;
  const auto umax = static_cast<float>(view.width - 1);
  const auto vmax = static_cast<float>(view.height - 1);
  const float unstable = 1.0F - o.unstable_bias;
  const float min_radius = o.radius_min_px / std::min(fx, fy);
  for (int i = 0; i < kBlockSize; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const float x = r00 * b.x[k] + r01 * b.y[k] + r02 * b.z[k] + tx;
    const float y = r10 * b.x[k] + r11 * b.y[k] + r12 * b.z[k] + ty;
    const float z = r20 * b.x[k] + r21 * b.y[k] + r22 * b.z[k] + tz;
    const float nx = r00 * b.nx[k] + r01 * b.ny[k] + r02 * b.nz[k];
    const float ny = r10 * b.nx[k] + r11 * b.ny[k] + r12 * b.nz[k];
    const float nz = r20 * b.nx[k] + r21 * b.ny[k] + r22 * b.nz[k];
    const float plane = nx * x + ny * y + nz * z;
    const float range = std::sqrt(x * x + y * y + z * z);
    const bool drawn =
        (b.radius[k] > 0.0F) & (z > o.near_m) & (z < o.far_m) & (-plane > o.facing_cos * range);
    const float safe_plane = drawn ? plane : -1.0F;
    const float safe_z = drawn ? z : 1.0F;
    const float r = std::max(b.radius[k], min_radius * safe_z);
    const float inv = 1.0F / safe_plane;
    const float iz = 1.0F / safe_z;
    // Half extents of the disc along the axes bound its projection exactly.
    const float ex = r * std::sqrt(std::max(0.0F, 1.0F - nx * nx));
    const float ey = r * std::sqrt(std::max(0.0F, 1.0F - ny * ny));
    const float ez = r * std::sqrt(std::max(0.0F, 1.0F - nz * nz));
    const float nearest = 1.0F / std::max(safe_z - ez, 0.25F * safe_z);
    const float eu = fx * (ex + std::abs(x * iz) * ez) * nearest;
    const float ev = fy * (ey + std::abs(y * iz) * ez) * nearest;
    const float u = fx * x * iz + cx;
    const float v = fy * y * iz + cy;
    d.x[k] = x;
    d.y[k] = y;
    d.z[k] = z;
    d.ax[k] = nx * inv;
    d.ay[k] = ny * inv;
    d.az[k] = nz * inv;
    d.r2[k] = r * r;
    d.yield[k] = o.rim_sigma * o.sensor.sigma(safe_z) * safe_z / (r * r);
    d.bias[k] = b.logit[k] < o.stable_logit ? unstable : 1.0F;
    const float left = std::ceil(std::clamp(u - eu, 0.0F, umax + 1.0F));
    const float right = std::floor(std::clamp(u + eu, -1.0F, umax));
    const float top = std::ceil(std::clamp(v - ev, 0.0F, vmax + 1.0F));
    const float bottom = std::floor(std::clamp(v + ev, -1.0F, vmax));
    d.u0[k] = static_cast<std::int32_t>(drawn ? left : 1.0F);
    d.u1[k] = static_cast<std::int32_t>(drawn ? right : 0.0F);
    d.v0[k] = static_cast<std::int32_t>(top);
    d.v1[k] = static_cast<std::int32_t>(bottom);
  }
}

// Four neighbouring pixels at once (GCC and Clang vector extensions, any processor).
constexpr int kLanes = 4;
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Long4 = std::int64_t __attribute__((vector_size(32)));

template <typename V, typename T>
V load(const T* from) {
  V v;
  std::memcpy(&v, from, sizeof(V));
  return v;
}

// Draws the discs into the keys. Rows of keys and ray_x are padded by kLanes: rays in the padding
// are NaN and hit nothing. Keys are positive, so that signed comparison serves.
void splat(const Discs& d, int count, std::uint32_t first_id, const View& view,
           std::int64_t* keys) {
  const Float4 half = {0.5F, 0.5F, 0.5F, 0.5F};
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (d.u1[k] < d.u0[k]) continue;
    const auto low = static_cast<std::int64_t>(~(first_id + static_cast<std::uint32_t>(i)));
    for (int v = d.v0[k]; v <= d.v1[k]; ++v) {
      const float ry = view.ray_y[static_cast<std::size_t>(v)];
      const float q_row = d.ay[k] * ry + d.az[k];
      std::int64_t* row = keys + static_cast<std::ptrdiff_t>(v) * view.width;
      for (int u = d.u0[k]; u <= d.u1[k]; u += kLanes) {
        const Float4 rx = load<Float4>(view.ray_x.data() + u);
        const Float4 q = d.ax[k] * rx + q_row;
        const Float4 dx = rx - d.x[k] * q;
        const Float4 dy = ry - d.y[k] * q;
        const Float4 dz = 1.0F - d.z[k] * q;
        const Float4 off2 =
            dx * dx + dy * dy + dz * dz;  // squared distance from the centre, times q^2
        const Int4 inside = (q > 0.0F) & (off2 <= d.r2[k] * q * q);
        const Float4 dome = d.yield[k] * off2;
        const Float4 compared = q * d.bias[k] * (1.0F - (dome < half ? dome : half));
        const Long4 high = __builtin_convertvector(std::bit_cast<Int4>(compared) & inside, Long4);
        const Long4 key = (high << 32) | low;
        const Long4 old = load<Long4>(row + u);
        const Long4 best = (high != 0) & (key > old) ? key : old;
        std::memcpy(row + u, &best, sizeof(best));
      }
    }
  }
}

void resolveRow(const SurfelMap& map, const View& view, const std::int64_t* keys, int v,
                Prediction& out) {
  const float ry = view.ray_y[static_cast<std::size_t>(v)];
  for (int u = 0; u < view.width; ++u) {
    const std::int64_t key = keys[static_cast<std::ptrdiff_t>(v) * view.width + u];
    if (key == 0) {
      out.id(u, v) = kNoSurfel;
      out.depth(u, v) = 0;
      out.logit(u, v) = 0;
      continue;
    }
    const std::uint32_t id = ~static_cast<std::uint32_t>(key);
    const SurfelBlock& b = map.block(static_cast<int>(id / kBlockSize));
    const std::size_t k = id % kBlockSize;
    const Eigen::Vector3f c = view.R * Eigen::Vector3f(b.x[k], b.y[k], b.z[k]) + view.t;
    const Eigen::Vector3f n = view.R * Eigen::Vector3f(b.nx[k], b.ny[k], b.nz[k]);
    const float rx = view.ray_x[static_cast<std::size_t>(u)];
    out.id(u, v) = id;
    out.depth(u, v) = n.dot(c) / (n.x() * rx + n.y() * ry + n.z());
    out.nx(u, v) = n.x();
    out.ny(u, v) = n.y();
    out.nz(u, v) = n.z();
    out.intensity(u, v) =
        (0.299F * b.red[k] + 0.587F * b.green[k] + 0.114F * b.blue[k]) * (1.0F / 255.0F);
    out.logit(u, v) = b.logit[k];
  }
}

}  // namespace

float logit(double probability) {
  return static_cast<float>(std::log(probability / (1.0 - probability)));
}

Prediction Prediction::nothing(const Camera& camera) {
  Prediction p;
  p.camera = camera;
  p.id = Image<std::uint32_t>(camera.width, camera.height, kNoSurfel);
  for (Image<float>* plane : {&p.depth, &p.nx, &p.ny, &p.nz, &p.intensity, &p.logit}) {
    *plane = Image<float>(camera.width, camera.height);
  }
  return p;
}

PredictOptions PredictOptions::from(const FusionConfig& config) {
  PredictOptions o;
  o.near_m = static_cast<float>(0.5 * config.sensor.depth_min_m);
  o.far_m = static_cast<float>(config.sensor.depth_max_m + 0.5);
  o.radius_min_px = static_cast<float>(config.surfels.radius_min_px);
  o.stable_logit = logit(config.surfels.stable_confidence);
  o.rim_sigma = static_cast<float>(config.surfels.rim_sigma);
  o.sensor = SensorModel(config.sensor);
  o.unstable_bias = static_cast<float>(config.surfels.unstable_bias);
  return o;
}

std::vector<int> visibleBlocks(const SurfelMap& map, const SE3& T_FC, const Camera& camera,
                               float near_m, float far_m) {
  const SE3 T_CF = T_FC.inverse();
  const Eigen::Matrix3f R = T_CF.R().cast<float>();
  const Eigen::Vector3f t = T_CF.t.cast<float>();
  // Planes through the camera centre along the image borders, normals pointing into the view.
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const float left = static_cast<float>(-0.5 - camera.cx) / fx;
  const float right = static_cast<float>(camera.width - 0.5 - camera.cx) / fx;
  const float top = static_cast<float>(-0.5 - camera.cy) / fy;
  const float bottom = static_cast<float>(camera.height - 0.5 - camera.cy) / fy;
  const std::array<Eigen::Vector3f, 4> planes = {
      Eigen::Vector3f(1, 0, -left).normalized(), Eigen::Vector3f(-1, 0, right).normalized(),
      Eigen::Vector3f(0, 1, -top).normalized(), Eigen::Vector3f(0, -1, bottom).normalized()};
  std::vector<int> visible;
  for (int i = 0; i < map.blocks(); ++i) {
    const SurfelBlock& b = map.block(i);
    if (b.count == 0) continue;
    const Eigen::Vector3f half = 0.5F * (b.upper - b.lower);
    const Eigen::Vector3f centre = R * (0.5F * (b.upper + b.lower)) + t;
    // Discs drawn larger than their radius reach at most a pixel or so beyond the box.
    const float reach =
        b.max_radius + 2.0F * std::max(centre.z() + half.norm(), 0.0F) / std::min(fx, fy);
    const auto outside = [&](const Eigen::Vector3f& n) {
      const Eigen::Vector3f n_F = R.transpose() * n;
      return n.dot(centre) + n_F.cwiseAbs().dot(half) + reach < 0.0F;
    };
    const float depth_half = R.row(2).cwiseAbs().dot(half) + reach;
    if (centre.z() + depth_half < near_m || centre.z() - depth_half > far_m) continue;
    if (std::none_of(planes.begin(), planes.end(), outside)) visible.push_back(i);
  }
  return visible;
}

void Predictor::predict(const SurfelMap& map, const SE3& T_FC, const Camera& camera,
                        const PredictOptions& options, Prediction& out) {
  if (out.camera != camera || out.depth.empty()) out = Prediction::nothing(camera);
  const View view = makeView(T_FC, camera);
  out.blocks = visibleBlocks(map, T_FC, camera, options.near_m, options.far_m);
  const int buffers = threads();
  keys_.resize(static_cast<std::size_t>(buffers));
  parallelChunks(buffers, [&](int chunk) {
    std::vector<std::int64_t>& keys = keys_[static_cast<std::size_t>(chunk)];
    keys.assign(out.depth.size() + kLanes, 0);
    Discs discs;
    const auto n = static_cast<int>(out.blocks.size());
    for (int i = chunk; i < n; i += buffers) {
      const int index = out.blocks[static_cast<std::size_t>(i)];
      const SurfelBlock& block = map.block(index);
      projectDiscs(block, view, options, discs);
      splat(discs, block.count, static_cast<std::uint32_t>(index) * kBlockSize, view, keys.data());
    }
  });
  parallelRows(camera.height, [&](int v) {
    std::int64_t* first = keys_[0].data() + static_cast<std::ptrdiff_t>(v) * camera.width;
    for (int b = 1; b < buffers; ++b) {
      const std::int64_t* other =
          keys_[static_cast<std::size_t>(b)].data() + static_cast<std::ptrdiff_t>(v) * camera.width;
      for (int u = 0; u < camera.width; ++u) first[u] = std::max(first[u], other[u]);
    }
    resolveRow(map, view, keys_[0].data(), v, out);
  });
}

}  // namespace rf
