// SPDX-License-Identifier: BSD-3-Clause
#include "analytic_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rf::test {
namespace {

// Uniform and normal numbers from a generator whose output the standard fixes.
double uniform(std::mt19937_64& g) { return (static_cast<double>(g() >> 11U) + 0.5) * 0x1.0p-53; }
double normal(std::mt19937_64& g) {
  return std::sqrt(-2.0 * std::log(uniform(g))) * std::cos(2.0 * std::numbers::pi * uniform(g));
}

// Distance along the ray to a box, infinity if missed.
double hit(const SceneBox& b, const Vec3& origin, const Vec3& direction) {
  const Vec3 o = b.T_WB.q.conjugate() * (origin - b.T_WB.t);
  const Vec3 d = b.T_WB.q.conjugate() * direction;
  double near = -std::numeric_limits<double>::infinity();
  double far = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double inv = 1.0 / (std::abs(d(i)) > 1e-12 ? d(i) : 1e-12);
    const double a = (-b.half(i) - o(i)) * inv;
    const double c = (b.half(i) - o(i)) * inv;
    near = std::max(near, std::min(a, c));
    far = std::min(far, std::max(a, c));
  }
  const double t = b.inside ? far : near;
  return (near <= far && t > 1e-6) ? t : std::numeric_limits<double>::infinity();
}

}  // namespace

Scene room() {
  Scene s;
  s.boxes.push_back({SE3(), Vec3(2.5, 1.3, 2.5), true, 0.0, false});
  s.boxes.push_back(
      {SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vec3::UnitY())), Vec3(-1.1, 0.8, 1.6)),
       Vec3(0.35, 0.5, 0.3), false, 1.0, false});
  s.boxes.push_back(
      {SE3(Eigen::Quaterniond(Eigen::AngleAxisd(-0.7, Vec3::UnitY())), Vec3(1.2, 0.9, 1.3)),
       Vec3(0.4, 0.4, 0.4), false, 2.0, false});
  return s;
}

SceneBox movingBox(const SE3& T_WB, const Vec3& half) { return {T_WB, half, false, 3.0, true}; }

Camera testCamera(int width, int height) {
  Camera c;
  c.width = width;
  c.height = height;
  c.fx = 0.82 * width;
  c.fy = 0.83 * width;
  c.cx = 0.5 * width - 1.3;
  c.cy = 0.5 * height + 0.7;
  return c;
}

double textureAt(const Vec3& p, double shift) {
  const double a = std::sin(5.0 * p.x() + shift) * std::cos(4.0 * p.y() - shift) +
                   std::sin(6.0 * p.z() + 2.0 * shift);
  const double b =
      std::sin(17.0 * p.x() + 9.0 * p.y()) * std::sin(13.0 * p.z() + 11.0 * p.y() + shift);
  return 0.5 + 0.14 * a + 0.16 * b;
}

Shot shoot(const Scene& scene, const SE3& T_WC, const Camera& camera, const ShotNoise& noise,
           std::int64_t seq) {
  Shot shot;
  shot.frame.seq = seq;
  shot.frame.utime = shot.frame.colour_utime = 1'000'000 + seq * 33'333;
  shot.frame.colour = Image<Rgb>(camera.width, camera.height);
  shot.frame.depth_mm = Image<std::uint16_t>(camera.width, camera.height);
  shot.dynamic = Image<std::uint8_t>(camera.width, camera.height);
  std::mt19937_64 random(noise.seed * 1'000'003ULL + static_cast<std::uint64_t>(seq));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vec3 ray = camera.backProject(u, v, 1.0);
      const Vec3 direction = T_WC.q * ray;
      double z = std::numeric_limits<double>::infinity();
      const SceneBox* seen = nullptr;
      for (const SceneBox& b : scene.boxes) {
        const double t = hit(b, T_WC.t, direction);
        if (t < z) {
          z = t;
          seen = &b;
        }
      }
      if (seen == nullptr) continue;
      const Vec3 p = seen->T_WB.inverse() * (T_WC * Vec3(ray * z));
      const double grey = 255.0 * textureAt(p, seen->texture) + noise.colour * normal(random);
      const auto byte = [](double c) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(c), 0L, 255L));
      };
      shot.frame.colour(u, v) = {byte(grey), byte(grey), byte(grey)};
      const double sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
      const double noisy = z + noise.depth * sigma * normal(random);
      shot.frame.depth_mm(u, v) =
          static_cast<std::uint16_t>(std::clamp(std::lround(1000.0 * noisy), 0L, 65535L));
      shot.dynamic(u, v) = seen->dynamic ? 1 : 0;
    }
  }
  return shot;
}

SE3 cameraAt(int k) {
  const double s = 0.03 * k;
  Vec6 xi;
  xi << 0.3 * std::sin(s), 0.06 * std::sin(0.7 * s), -1.2, 0.03 * std::sin(s), 0.15 * std::sin(s),
      0;
  return SE3::exp(xi);
}

SegmentationResult truth(const Shot& shot, const Shot* previous, const SE3& camera_motion,
                         const SE3& object_motion, bool moving) {
  SegmentationResult s;
  s.utime = shot.frame.utime;
  s.utime_a = previous != nullptr ? previous->frame.utime : 0;
  s.seq = shot.frame.seq;
  s.reduction = 2;
  s.first = previous == nullptr;
  s.object_moving = moving;
  const int w = shot.dynamic.width() / 2, h = shot.dynamic.height() / 2;
  s.label = Image<std::uint8_t>(w, h, 0);
  s.score = Image<std::uint8_t>(w, h, 255);
  s.gamma = {1.0F, 0.0F};
  double dynamic = 0, valid = 0;
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      if (shot.frame.depth_mm(2 * u, 2 * v) == 0) continue;
      valid += 1;
      if (!moving || shot.dynamic(2 * u, 2 * v) == 0) continue;
      s.score(u, v) = 0;
      s.label(u, v) = 1;
      dynamic += 1;
    }
  }
  s.dynamic_share = valid > 0 ? dynamic / valid : 0;
  s.camera.T_AB = camera_motion;
  s.camera.covariance.setZero();
  s.camera.covariance.diagonal() << 4e-6, 4e-6, 4e-6, 1.8e-4, 1.8e-4, 1.8e-4;
  s.camera.health = Health::kTracked;
  s.object = s.camera;
  s.object.T_AB = object_motion;
  return s;
}

}  // namespace rf::test
