// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/colour_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/parallel.hpp"
#include "simulation/random.hpp"
#include "simulation/sensor_noise.hpp"

namespace rf::sim {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;
constexpr float kBlurFrom = 0.6F;  // pixels; below it nothing is blurred
constexpr int kMostSamples = 15;
constexpr float kTargetMean = 0.36F;  // linear mean that the automatic exposure aims at
constexpr int kToneSteps = 4096;

/// Displayed value 0..255 of linear light 0..1: gamma with a soft shoulder and slight contrast.
std::array<float, kToneSteps + 1> toneTable() {
  std::array<float, kToneSteps + 1> table{};
  for (int i = 0; i <= kToneSteps; ++i) {
    const double x = 1.25 * i / kToneSteps;
    const double shoulder = x < 0.6 ? x : 0.6 + 0.4 * (1 - std::exp(-(x - 0.6) / 0.4));
    const double gamma = std::pow(shoulder / 0.93, 1 / 2.2);
    const double contrast = gamma + 0.05 * std::sin(2 * std::numbers::pi * (gamma - 0.5));
    table[static_cast<std::size_t>(i)] = static_cast<float>(255 * std::clamp(contrast, 0.0, 1.0));
  }
  return table;
}

const std::array<float, kToneSteps + 1> kTone = toneTable();

float tone(float linear) {
  const float at = std::clamp(linear / 1.25F, 0.0F, 1.0F) * kToneSteps;
  return kTone[static_cast<std::size_t>(at)];
}

/// Weights 1 6 1 over 8 along rows or columns.
Image<Vector3f> softened(const Image<Vector3f>& in) {
  Image<Vector3f> rows(in.width(), in.height(), Vector3f::Zero());
  parallelRows(in.height(), [&](int v) {
    for (int u = 0; u < in.width(); ++u) {
      const Vector3f& left = in(std::max(u - 1, 0), v);
      const Vector3f& right = in(std::min(u + 1, in.width() - 1), v);
      rows(u, v) = 0.75F * in(u, v) + 0.125F * (left + right);
    }
  });
  Image<Vector3f> out(in.width(), in.height(), Vector3f::Zero());
  parallelRows(in.height(), [&](int v) {
    const int up = std::max(v - 1, 0);
    const int low = std::min(v + 1, in.height() - 1);
    for (int u = 0; u < in.width(); ++u) {
      out(u, v) = 0.75F * rows(u, v) + 0.125F * (rows(u, up) + rows(u, low));
    }
  });
  return out;
}

float meanBrightness(const Image<Vector3f>& light) {
  double sum = 0;
  int n = 0;
  for (int v = 2; v < light.height(); v += 4) {
    for (int u = 2; u < light.width(); u += 4, ++n) {
      sum += std::min(1.2F, light(u, v).mean());
    }
  }
  return static_cast<float>(sum / std::max(1, n));
}

}  // namespace

Image<Vector2f> shutterFlow(const World& world, const SurfaceImage& surface,
                            std::span<const SE3> T_CB, std::span<const SE3> T_CB_open,
                            std::span<const SE3> T_CB_close) {
  struct Motion {
    Eigen::Matrix3f R;
    Vector3f t;
  };
  std::vector<std::array<Motion, 2>> motions;
  for (std::size_t b = 0; b < T_CB.size(); ++b) {
    const SE3 opened = T_CB_open[b] * T_CB[b].inverse();
    const SE3 closed = T_CB_close[b] * T_CB[b].inverse();
    motions.push_back({Motion{opened.R().cast<float>(), opened.t.cast<float>()},
                       Motion{closed.R().cast<float>(), closed.t.cast<float>()}});
  }
  const Camera& c = world.camera;
  const Vector2f focal(static_cast<float>(c.fx), static_cast<float>(c.fy));
  Image<Vector2f> flow(c.width, c.height, Vector2f::Zero());
  parallelRows(c.height, [&](int v) {
    for (int u = 0; u < c.width; ++u) {
      if (surface.primitive(u, v) < 0) continue;
      const auto body = static_cast<std::size_t>(
          world.primitives[static_cast<std::size_t>(surface.primitive(u, v))].body);
      const Vector3f p = surface.z(u, v) * c.backProject(u, v, 1.0).cast<float>();
      const Vector3f a = motions[body][0].R * p + motions[body][0].t;
      const Vector3f b = motions[body][1].R * p + motions[body][1].t;
      if (a.z() < 0.05F || b.z() < 0.05F) continue;
      flow(u, v) = focal.cwiseProduct(b.head<2>() / b.z() - a.head<2>() / a.z());
    }
  });
  return flow;
}

Image<Vector3f> blurred(const Image<Vector3f>& light, const Image<Vector2f>& flow) {
  Image<Vector3f> out = light;
  parallelRows(light.height(), [&](int v) {
    for (int u = 0; u < light.width(); ++u) {
      const Vector2f& f = flow(u, v);
      const float length = f.norm();
      if (length < kBlurFrom) continue;
      const int n = std::clamp(static_cast<int>(std::ceil(length)) + 1, 3, kMostSamples);
      Vector3f sum = Vector3f::Zero();
      for (int k = 0; k < n; ++k) {
        const float s = (static_cast<float>(k) + 0.5F) / static_cast<float>(n) - 0.5F;
        const int i =
            std::clamp(u + static_cast<int>(std::lround(s * f.x())), 0, light.width() - 1);
        const int j =
            std::clamp(v + static_cast<int>(std::lround(s * f.y())), 0, light.height() - 1);
        sum += light(i, j);
      }
      out(u, v) = sum / static_cast<float>(n);
    }
  });
  return out;
}

ColourResponse responseAt(int frame, std::uint64_t seed, const Image<Vector3f>& light) {
  Random random(seed, 0xC0109);
  const double t = frame / kFrameRate;
  const auto wave = [&](double size) {
    const double period = random.uniform(1.5, 6.0);
    const double phase = random.uniform(0, 2 * std::numbers::pi);
    return size * std::sin(2 * std::numbers::pi * t / period + phase);
  };
  ColourResponse r;
  const double wobble = wave(0.025) + wave(0.02) + wave(0.012);
  const float brightness = std::max(0.02F, meanBrightness(light));
  r.gain = static_cast<float>(random.uniform(0.92, 1.12) * (1 + wobble)) *
           std::sqrt(kTargetMean / brightness);
  const auto red = static_cast<float>(random.uniform(0.93, 1.05) + wave(0.01));
  const auto blue = static_cast<float>(random.uniform(0.94, 1.08) + wave(0.012));
  r.balance = {red, 1.0F, blue};
  r.vignette = static_cast<float>(random.uniform(0.12, 0.26));
  r.noise = static_cast<float>(random.uniform(1.8, 2.8));
  return r;
}

Image<Rgb> develop(const Image<Vector3f>& light, const ColourResponse& response,
                   std::uint64_t key) {
  const int width = light.width();
  const int height = light.height();
  const Image<Vector3f> soft = softened(light);
  const Image<float> grain = correlatedNoise(width, height, 0, scramble(key, 1));
  const Image<float> red = correlatedNoise(width, height, 2, scramble(key, 2));
  const Image<float> blue = correlatedNoise(width, height, 2, scramble(key, 3));
  const float far = 0.25F * static_cast<float>(width * width + height * height);
  Image<Rgb> out(width, height);
  parallelRows(height, [&](int v) {
    for (int u = 0; u < width; ++u) {
      const float x = static_cast<float>(u) - 0.5F * static_cast<float>(width);
      const float y = static_cast<float>(v) - 0.5F * static_cast<float>(height);
      const float gain = response.gain * (1 - response.vignette * (x * x + y * y) / far);
      const Vector3f linear = gain * soft(u, v).cwiseProduct(response.balance);
      const Vector3f shown(tone(linear.x()), tone(linear.y()), tone(linear.z()));
      // Shot noise after the tone curve: strongest in the darker middle tones.
      const float strength = response.noise * (1.25F - shown.mean() / 255.0F);
      const float g = strength * grain(u, v);
      const auto clip = [](float value) {
        return static_cast<std::uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F));
      };
      out(u, v) = {clip(shown.x() + g + 0.8F * strength * red(u, v)), clip(shown.y() + g),
                   clip(shown.z() + g + strength * blue(u, v))};
    }
  });
  return out;
}

}  // namespace rf::sim
