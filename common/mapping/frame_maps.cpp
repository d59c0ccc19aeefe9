// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/frame_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

constexpr int kRows = 16;  // rows a chunk; fixed, so that thread counts do not matter

// Largest step between neighbours that is still one surface; grazing floors need a generous one.
float edgeStep(float z) { return std::max(0.03F, 0.04F * z); }

void smoothRow(const Image<float>& depth, const SensorModel& sensor, int v, Image<float>& out,
               std::vector<float>& sum, std::vector<float>& total) {
  constexpr std::array<float, 3> kSpatial = {1.0F, 0.8F, 0.41F};  // gaussian, sigma 1.5 px
  const int w = depth.width();
  const float* centre = depth.row(v);
  std::fill(sum.begin(), sum.end(), 0.0F);
  std::fill(total.begin(), total.end(), 0.0F);
  std::vector<float> inv(static_cast<std::size_t>(w));
  for (int u = 0; u < w; ++u) {
    const float reach = 4.0F * sensor.sigma(centre[u]) + 0.004F;
    inv[static_cast<std::size_t>(u)] = 1.0F / (reach * reach);
  }
  for (int dv = -2; dv <= 2; ++dv) {
    if (v + dv < 0 || v + dv >= depth.height()) continue;
    const float* row = depth.row(v + dv);
    for (int du = -2; du <= 2; ++du) {
      const float spatial = kSpatial[static_cast<std::size_t>(std::abs(dv))] *
                            kSpatial[static_cast<std::size_t>(std::abs(du))];
      const int begin = std::max(0, -du);
      const int end = std::min(w, w - du);
      float* s = sum.data();
      float* t = total.data();
      const float* in = inv.data();
      for (int u = begin; u < end; ++u) {
        const float d = row[u + du];
        const float e = d - centre[u];
        const float f = std::max(0.0F, 1.0F - e * e * in[u]);
        const float weight = spatial * f * f;
        s[u] += weight * e;
        t[u] += weight;
      }
    }
  }
  for (int u = 0; u < w; ++u) {
    const auto k = static_cast<std::size_t>(u);
    out(u, v) = centre[u] > 0.0F ? centre[u] + sum[k] / std::max(total[k], 1e-6F) : 0.0F;
  }
}

// Sums over (2r+1)^2 windows, clipped at the border.
Image<float> boxSum(const Image<float>& in, int r) {
  const int w = in.width();
  const int h = in.height();
  Image<float> across(w, h);
  Image<float> out(w, h);
  for (int v = 0; v < h; ++v) {
    for (int d = -r; d <= r; ++d) {
      const float* src = in.row(v);
      float* dst = across.row(v);
      for (int u = std::max(0, -d); u < std::min(w, w - d); ++u) dst[u] += src[u + d];
    }
  }
  for (int v = 0; v < h; ++v) {
    float* dst = out.row(v);
    for (int d = std::max(-r, -v); d <= std::min(r, h - 1 - v); ++d) {
      const float* src = across.row(v + d);
      for (int u = 0; u < w; ++u) dst[u] += src[u];
    }
  }
  return out;
}

}  // namespace

void limitDepth(const SensorConfig& sensor, Image<float>& depth) {
  const auto low = static_cast<float>(sensor.depth_min_m);
  const auto high = static_cast<float>(sensor.depth_max_m);
  for (float& z : depth) z = (z >= low && z <= high) ? z : 0.0F;  // NaN fails both
}

Image<float> smoothDepth(const Image<float>& depth, const SensorModel& sensor) {
  Image<float> out(depth.width(), depth.height());
  parallelChunks((depth.height() + kRows - 1) / kRows, [&](int chunk) {
    std::vector<float> sum(static_cast<std::size_t>(depth.width()));
    std::vector<float> total(sum.size());
    const int end = std::min(depth.height(), (chunk + 1) * kRows);
    for (int v = chunk * kRows; v < end; ++v) smoothRow(depth, sensor, v, out, sum, total);
  });
  return out;
}

void computeNormals(const Image<float>& z, FrameMaps& maps) {
  const Camera& c = maps.camera;
  const auto ifx = static_cast<float>(1.0 / c.fx), ify = static_cast<float>(1.0 / c.fy);
  const auto cx = static_cast<float>(c.cx), cy = static_cast<float>(c.cy);
  for (Image<float>* plane : {&maps.nx, &maps.ny, &maps.nz})
    *plane = Image<float>(c.width, c.height);
  parallelRows(c.height, [&](int v) {
    if (v == 0 || v == c.height - 1) return;
    const float* up = z.row(v - 1);
    const float* mid = z.row(v);
    const float* down = z.row(v + 1);
    const float y = (static_cast<float>(v) - cy) * ify;
    float* nx = maps.nx.row(v);
    float* ny = maps.ny.row(v);
    float* nz = maps.nz.row(v);
    for (int u = 1; u + 1 < c.width; ++u) {
      const float z0 = mid[u], zl = mid[u - 1], zr = mid[u + 1], zu = up[u], zd = down[u];
      const float x = (static_cast<float>(u) - cx) * ifx;
      const float step = edgeStep(z0);
      const bool ok = (z0 > 0) & (zl > 0) & (zr > 0) & (zu > 0) & (zd > 0) &
                      (std::abs(zl - z0) < step) & (std::abs(zr - z0) < step) &
                      (std::abs(zu - z0) < step) & (std::abs(zd - z0) < step);
      // Tangents along the row (a) and the column (b); the normal b x a faces the camera.
      const float ax = (x + ifx) * zr - (x - ifx) * zl, ay = y * (zr - zl), az = zr - zl;
      const float bx = x * (zd - zu), by = (y + ify) * zd - (y - ify) * zu, bz = zd - zu;
      const float px = by * az - bz * ay;
      const float py = bz * ax - bx * az;
      const float pz = bx * ay - by * ax;
      const float norm = std::sqrt(px * px + py * py + pz * pz);
      const float s = ok && norm > 0 ? 1.0F / norm : 0.0F;
      nx[u] = px * s;
      ny[u] = py * s;
      nz[u] = pz * s;
    }
  });
}

Image<float> nearestAround(const Image<float>& depth) {
  constexpr float kNone = 1e9F;
  const int w = depth.width();
  const int h = depth.height();
  Image<float> low(w, h, kNone), count(w, h), out(w, h);
  for (int v = 0; v < h; ++v) {
    const float* d = depth.row(v);
    for (int u = 1; u + 1 < w; ++u) {
      const float a = d[u - 1] > 0 ? d[u - 1] : kNone;
      const float b = d[u] > 0 ? d[u] : kNone;
      const float c = d[u + 1] > 0 ? d[u + 1] : kNone;
      low(u, v) = std::min(a, std::min(b, c));
      count(u, v) =
          (d[u - 1] > 0 ? 1.0F : 0.0F) + (d[u] > 0 ? 1.0F : 0.0F) + (d[u + 1] > 0 ? 1.0F : 0.0F);
    }
  }
  for (int v = 1; v + 1 < h; ++v) {
    for (int u = 1; u + 1 < w; ++u) {
      const float n = count(u, v - 1) + count(u, v) + count(u, v + 1);
      const float z = std::min(low(u, v - 1), std::min(low(u, v), low(u, v + 1)));
      out(u, v) = n >= 6.0F ? z : 0.0F;
    }
  }
  return out;
}

Image<Rgb> reduceColour(const Image<Rgb>& colour, int f) {
  if (f == 1) return colour;
  Image<Rgb> out(colour.width() / f, colour.height() / f);
  parallelRows(out.height(), [&](int v) {
    for (int u = 0; u < out.width(); ++u) {
      int r = 0, g = 0, b = 0;
      for (int y = v * f; y < (v + 1) * f; ++y) {
        const Rgb* row = colour.row(y) + static_cast<std::ptrdiff_t>(u) * f;
        for (int x = 0; x < f; ++x) {
          r += row[x].r;
          g += row[x].g;
          b += row[x].b;
        }
      }
      const int n = f * f;
      const auto mean = [n](int sum) { return static_cast<std::uint8_t>((sum + n / 2) / n); };
      out(u, v) = {mean(r), mean(g), mean(b)};
    }
  });
  return out;
}

FrameMaps makeFrameMaps(const Camera& camera, const Image<float>& depth, Image<Rgb> colour,
                        const SensorConfig& sensor) {
  FrameMaps maps;
  maps.camera = camera;
  maps.depth = depth;
  limitDepth(sensor, maps.depth);
  maps.colour = std::move(colour);
  computeNormals(smoothDepth(maps.depth, SensorModel(sensor)), maps);
  maps.farthest_clear = nearestAround(maps.depth);
  return maps;
}

SplitWeights splitWeights(const Image<std::uint8_t>& score, const Image<float>& depth) {
  const int w = depth.width();
  const int h = depth.height();
  SplitWeights out;
  for (BodyWeights* body : {&out.world, &out.object}) {
    body->own = Image<float>(w, h);
    body->interior = Image<std::uint8_t>(w, h);
  }
  if (std::all_of(score.begin(), score.end(), [](std::uint8_t s) { return s == 255; })) {
    for (std::size_t i = 0; i < depth.size(); ++i) {
      out.world.own[i] = depth[i] > 0 ? 1.0F : 0.0F;
      out.world.interior[i] = depth[i] > 0 ? 1 : 0;
    }
    return out;
  }
  Image<float> valid(w, h), gamma(w, h);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    valid[i] = depth[i] > 0 ? 1.0F : 0.0F;
    gamma[i] = valid[i] * static_cast<float>(score[i]) / 255.0F;
  }
  const Image<float> valid5 = boxSum(valid, 2), gamma5 = boxSum(gamma, 2);
  const Image<float> valid3 = boxSum(valid, 1), gamma3 = boxSum(gamma, 1);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!(depth[i] > 0)) continue;
    const float mean = gamma5[i] / valid5[i];
    const float near = gamma3[i] / valid3[i];
    out.world.own[i] = gamma[i] * mean;
    out.object.own[i] = (1.0F - gamma[i]) * (1.0F - mean);
    out.world.interior[i] = near > 0.9F ? 1 : 0;
    out.object.interior[i] = near < 0.1F ? 1 : 0;
  }
  return out;
}

}  // namespace rf
