// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/depth_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/parallel.hpp"
#include "simulation/random.hpp"
#include "simulation/sensor_noise.hpp"

namespace rf::sim {
namespace {

constexpr float kNearest = 0.4F;
constexpr float kFarthest = 5.0F;
constexpr float kFocalBaseline = static_cast<float>(kBaseline * kInfraredFocal);
constexpr float kEdgeWander = 1.3F;  // pixels, standard deviation of a depth edge's place

struct Fields {
  Image<float> fine;    ///< depth noise alike over 3 px
  Image<float> coarse;  ///< and over 13 px
  Image<float> wander_u, wander_v;
  Image<float> fade;  ///< decides on holes
};

Fields noiseFields(int width, int height, std::uint64_t key) {
  const auto field = [&](int radius, std::uint64_t purpose) {
    return correlatedNoise(width, height, radius, scramble(key, purpose));
  };
  return {field(1, 1), field(6, 2), field(2, 3), field(2, 4), field(3, 5)};
}

/// 1 where a depth edge is within three pixels.
Image<std::uint8_t> nearEdges(const Image<float>& z) {
  const int reach = 3;
  Image<std::uint8_t> rows(z.width(), z.height());
  parallelRows(z.height(), [&](int v) {
    for (int u = 0; u < z.width(); ++u) {
      const float a = z(u, v);
      const float limit = 0.03F + 0.03F * a;
      const bool edge = (u + 1 < z.width() && std::abs(z(u + 1, v) - a) > limit) ||
                        (v + 1 < z.height() && std::abs(z(u, v + 1) - a) > limit);
      if (!edge) continue;
      const int last = std::min(u + reach, z.width() - 1);
      for (int k = std::max(0, u - reach); k <= last; ++k) rows(k, v) = 1;
    }
  });
  Image<std::uint8_t> out(z.width(), z.height());
  parallelRows(z.height(), [&](int v) {
    const int last = std::min(v + reach, z.height() - 1);
    std::uint8_t* target = out.row(v);
    for (int k = std::max(0, v - reach); k <= last; ++k) {
      const std::uint8_t* source = rows.row(k);
      for (int u = 0; u < z.width(); ++u) target[u] |= source[u];
    }
  });
  return out;
}

/// 1 where the projector, to the camera's right, does not shine: some surface nearer to it covers
/// the same projector column.
Image<std::uint8_t> projectorShadow(const Image<float>& z) {
  Image<std::uint8_t> out(z.width(), z.height());
  parallelRows(z.height(), [&](int v) {
    float covered_from = 1e9F;
    for (int u = z.width() - 1; u >= 0; --u) {
      if (z(u, v) <= 0) continue;
      const float column = static_cast<float>(u) - kFocalBaseline / z(u, v);
      out(u, v) = column > covered_from + 1.0F ? 1 : 0;
      covered_from = std::min(covered_from, column);
    }
  });
  return out;
}

/// Registration to the colour camera leaves borders without depth, here with a ragged rim.
bool inBorder(int u, int v, int width, int height, float wander) {
  const float ragged = wander;
  const auto x = static_cast<float>(u) + ragged;
  const auto y = static_cast<float>(v) + ragged;
  return x < 10 || y < 6 || x > static_cast<float>(width - 26) ||
         y > static_cast<float>(height - 11);
}

float sigmaBeforeSteps(float z) {
  const float step = z * z * static_cast<float>(kDisparityStep) / kFocalBaseline;
  const auto sigma = static_cast<float>(depthSigma(z));
  return std::sqrt(std::max(0.04F * sigma * sigma, sigma * sigma - step * step / 12.0F));
}

/// Whether enough of the pattern comes back.
bool patternSeen(float z, float cosine, float infrared, float fade) {
  const float distance = std::min(1.0F, 6.0F / (z * z));
  const float strength = infrared * (0.25F + 0.75F * cosine) * distance;
  return strength > 0.055F + 0.02F * fade && cosine > 0.13F + 0.04F * fade;
}

float quantised(float z) {
  const float disparity = kFocalBaseline / z;
  const auto step = static_cast<float>(kDisparityStep);
  return kFocalBaseline / (std::max(1.0F, std::round(disparity / step)) * step);
}

std::uint8_t maskOf(int body, int first_robot_body) {
  if (body == 0) return 1;
  return body < first_robot_body ? 2 : 3;
}

}  // namespace

double depthSigma(double z) { return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4); }

DepthOutput senseDepth(const DepthInput& in, const Camera& camera, std::uint64_t key,
                       float noise_factor) {
  const int width = camera.width;
  const int height = camera.height;
  const Fields fields = noiseFields(width, height, key);
  const Image<std::uint8_t> edges = nearEdges(in.z);
  const Image<std::uint8_t> shadow = projectorShadow(in.z);
  DepthOutput out{Image<std::uint16_t>(width, height), Image<std::uint8_t>(width, height)};
  parallelRows(height, [&](int v) {
    for (int u = 0; u < width; ++u) {
      if (inBorder(u, v, width, height, 0.8F * fields.wander_u(u, v))) continue;
      int su = u;
      int sv = v;
      if (edges(u, v) != 0) {
        if (fields.fade(u, v) > 1.6F) continue;
        su = std::clamp(u + static_cast<int>(std::lround(kEdgeWander * fields.wander_u(u, v))), 0,
                        width - 1);
        sv = std::clamp(v + static_cast<int>(std::lround(kEdgeWander * fields.wander_v(u, v))), 0,
                        height - 1);
      }
      const float z = in.z(su, sv);
      const float cosine = in.cosine(su, sv);
      if (z <= 0 || shadow(su, sv) != 0) continue;
      if (!patternSeen(z, cosine, in.infrared(su, sv), fields.fade(u, v))) continue;
      const float slant = std::min(1.6F, 1.0F / std::sqrt(std::max(cosine, 0.05F)));
      const float noise = noise_factor * (0.85F * fields.fine(u, v) + 0.527F * fields.coarse(u, v));
      const float measured = quantised(std::max(0.2F, z + slant * sigmaBeforeSteps(z) * noise));
      if (measured < kNearest || measured > kFarthest) continue;
      out.depth(u, v) =
          static_cast<std::uint16_t>(std::lround(measured * static_cast<float>(kDepthFactor)));
      out.mask(u, v) = maskOf(in.body(su, sv), in.first_robot_body);
    }
  });
  return out;
}

}  // namespace rf::sim
