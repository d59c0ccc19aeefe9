// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/prediction.hpp"

#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "geometry/parallel.hpp"

namespace rf {
namespace {

double uniform(std::mt19937_64& g, double low, double high) {
  return low + (high - low) * static_cast<double>(g() >> 11U) * 0x1.0p-53;
}

// Surfels scattered on two wavy sheets and at random.
SurfelMap scatteredMap(int count) {
  std::mt19937_64 random(21);
  SurfelMap map;
  for (int i = 0; i < count; ++i) {
    Surfel s;
    const double x = uniform(random, -1.5, 1.5), y = uniform(random, -1.2, 1.2);
    const double z =
        i % 3 == 0 ? uniform(random, 0.5, 4.0) : (i % 3 == 1 ? 2.0 : 3.0) + 0.1 * std::sin(5 * x);
    s.point = Vec3(x, y, z).cast<float>();
    s.normal = Vec3(uniform(random, -0.6, 0.6), uniform(random, -0.6, 0.6), -1.0)
                   .normalized()
                   .cast<float>();
    s.radius = static_cast<float>(uniform(random, 0.005, 0.04));
    s.logit = static_cast<float>(uniform(random, -2.5, 2.0));
    s.colour = Eigen::Vector3f(100, 120, 140);
    map.append(s);
  }
  return map;
}

struct Hit {
  std::uint32_t id = kNoSurfel;
  double depth = 0, compared = 0;
};

// The definition, written plainly in double precision: every surfel against one ray.
Hit bruteForce(const SurfelMap& map, const SE3& T_FC, const Camera& camera, const PredictOptions& o,
               int u, int v) {
  const SE3 T_CF = T_FC.inverse();
  const Vec3 ray = camera.backProject(u, v, 1.0);
  Hit best;
  for (int b = 0; b < map.blocks(); ++b) {
    for (int slot = 0; slot < map.block(b).count; ++slot) {
      const Surfel s = map.block(b).get(slot);
      const Vec3 c = T_CF * Vec3(s.point.cast<double>());
      const Vec3 n = T_CF.q * Vec3(s.normal.cast<double>());
      if (c.z() <= o.near_m || c.z() >= o.far_m || -n.dot(c) <= o.facing_cos * c.norm()) continue;
      const double z = n.dot(c) / n.dot(ray);
      if (!(z > 0)) continue;
      const double r =
          std::max<double>(s.radius, o.radius_min_px / std::min(camera.fx, camera.fy) * c.z());
      const double off2 = (ray * z - c).squaredNorm();
      if (off2 > r * r) continue;
      const double bias = s.logit < o.stable_logit ? 1.0 - o.unstable_bias : 1.0;
      const double rim = o.rim_sigma * o.sensor.sigma(static_cast<float>(c.z())) / c.z();
      const double dome = 1.0 - std::min(0.5, rim * c.z() * c.z() * off2 / (r * r * z * z));
      if (bias * dome / z <= best.compared) continue;
      best = {static_cast<std::uint32_t>(b * kBlockSize + slot), z, bias * dome / z};
    }
  }
  return best;
}

TEST(Prediction, EqualsTheBruteForceReference) {
  const SurfelMap map = scatteredMap(3000);
  const Camera camera = test::testCamera(80, 60);
  const SE3 T_FC(Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vec3(0.2, 1, 0.3).normalized())),
                 Vec3(0.1, -0.05, 0.1));
  const PredictOptions options;
  Predictor predictor;
  Prediction p;
  predictor.predict(map, T_FC, camera, options, p);
  int seen = 0, other_id = 0, other_depth = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Hit h = bruteForce(map, T_FC, camera, options, u, v);
      seen += h.id != kNoSurfel ? 1 : 0;
      other_id += h.id != p.id(u, v) ? 1 : 0;
      other_depth += std::abs(h.depth - p.depth(u, v)) > 1e-4 ? 1 : 0;
    }
  }
  // Float against double may differ where a ray grazes a rim: at most 0.1 % of the pixels.
  EXPECT_GT(seen, camera.width * camera.height / 2);
  EXPECT_LE(other_id, camera.width * camera.height / 1000);
  EXPECT_LE(other_depth, camera.width * camera.height / 1000);
}

TEST(Prediction, IsTheSameForEveryThreadCount) {
  const SurfelMap map = scatteredMap(20000);
  const Camera camera = test::testCamera(160, 120);
  Prediction one, two;
  setThreads(1);
  Predictor().predict(map, SE3(), camera, {}, one);
  setThreads(2);
  Predictor().predict(map, SE3(), camera, {}, two);
  setThreads(1);
  EXPECT_EQ(one.id, two.id);
  EXPECT_EQ(one.depth, two.depth);
  EXPECT_EQ(one.nz, two.nz);
  EXPECT_EQ(one.intensity, two.intensity);
}

TEST(Prediction, ShowsNothingFromBehindAndPrefersStableSurfels) {
  SurfelMap map;
  Surfel s;
  s.normal = Eigen::Vector3f(0, 0, -1);
  s.radius = 0.2F;
  s.point = Eigen::Vector3f(0, 0, 2.0F);
  s.logit = 2.0F;
  const std::uint32_t stable = map.append(s);
  s.point.z() = 1.99F;  // before it, but unstable and within the bias
  s.logit = -2.0F;
  map.append(s);
  s.point.z() = 1.5F;  // before both, but facing away
  s.normal.z() = 1.0F;
  s.logit = 3.0F;
  map.append(s);
  const Camera camera = test::testCamera(80, 60);
  Prediction p;
  Predictor().predict(map, SE3(), camera, {}, p);
  EXPECT_EQ(p.id(40, 30), stable);
  EXPECT_NEAR(p.depth(40, 30), 2.0F, 1e-4F);
}

TEST(SurfelMap, CompactsInOrderAndRefusesWhatItCannotHold) {
  SurfelMap map(0.25, 5);
  Surfel s;
  s.normal = Eigen::Vector3f(0, 0, -1);
  for (int i = 0; i < 5; ++i) {
    s.radius = static_cast<float>(i + 1);
    s.point = Eigen::Vector3f(0.1F, 0.1F, 0.01F * static_cast<float>(i));
    EXPECT_NE(map.append(s), kNoSurfel);
  }
  EXPECT_EQ(map.append(s), kNoSurfel) << "full";
  map.block(0).radius[1] = 0;
  map.block(0).radius[3] = 0;
  map.compact(0);
  EXPECT_EQ(map.size(), 3);
  EXPECT_FLOAT_EQ(map.get(0).radius, 1);
  EXPECT_FLOAT_EQ(map.get(1).radius, 3);
  EXPECT_FLOAT_EQ(map.get(2).radius, 5);
  s.point.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(map.append(s), kNoSurfel);
  s.point.x() = 1e9F;
  EXPECT_EQ(map.append(s), kNoSurfel);
}

}  // namespace
}  // namespace rf
