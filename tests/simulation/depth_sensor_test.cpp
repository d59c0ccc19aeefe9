// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/depth_sensor.hpp"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "simulation/sensor_noise.hpp"

namespace rf::sim {
namespace {

Camera camera() {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.fx = 570;
  c.fy = 567;
  c.cx = 315;
  c.cy = 243;
  return c;
}

/// A wall straight ahead, bright and facing the camera.
DepthInput wall(float z) {
  return {Image<float>(640, 480, z), Image<float>(640, 480, 1.0F), Image<float>(640, 480, 0.7F),
          Image<std::uint8_t>(640, 480, 0)};
}

double metres(std::uint16_t depth) { return depth / kDepthFactor; }

TEST(DepthSensor, NoiseGrowsAsTheModelSays) {
  for (const float z : {0.6F, 1.0F, 1.5F, 2.0F, 3.0F, 4.0F}) {
    double sum = 0;
    double square = 0;
    int n = 0;
    for (std::uint64_t key = 0; key < 4; ++key) {
      const DepthOutput out = senseDepth(wall(z), camera(), key);
      for (const std::uint16_t d : out.depth) {
        if (d == 0) continue;
        const double error = metres(d) - static_cast<double>(z);
        sum += error;
        square += error * error;
        ++n;
      }
    }
    const double mean = sum / n;
    const double sigma = std::sqrt(square / n - mean * mean);
    std::printf("z %.1f m: sigma %.4f m, model %.4f m, bias %.4f m\n", static_cast<double>(z),
                sigma, depthSigma(z), mean);
    // The mean over correlated pixels and the fixed phase of the disparity steps leave some play.
    EXPECT_NEAR(sigma, depthSigma(z), 0.25 * depthSigma(z)) << "at " << z;
    EXPECT_NEAR(mean, 0.0, 0.35 * depthSigma(z)) << "at " << z;
  }
}

TEST(DepthSensor, TheNoiseFactorScalesWhatIsNotOfTheSteps) {
  const auto sigma = [](float factor) {
    double square = 0;
    int n = 0;
    for (const std::uint16_t d : senseDepth(wall(1.0F), camera(), 5, factor).depth) {
      if (d == 0) continue;
      square += (metres(d) - 1.0) * (metres(d) - 1.0);
      ++n;
    }
    return std::sqrt(square / n);
  };
  // Steps of 2.9 mm at 1 m (0.84 mm rms) and the rest of the model's 1.9 mm.
  const double steps = 0.00292 * 0.00292 / 12.0;
  const double rest = depthSigma(1.0) * depthSigma(1.0) - steps;
  EXPECT_NEAR(sigma(1), std::sqrt(steps + rest), 0.1 * depthSigma(1.0));
  EXPECT_NEAR(sigma(2), std::sqrt(steps + 4 * rest), 0.2 * depthSigma(1.0));
  EXPECT_LT(sigma(0), 0.0017) << "less than a step";
}

TEST(DepthSensor, DisparityComesInEighthsOfAPixel) {
  const DepthOutput out = senseDepth(wall(2.0F), camera(), 7);
  for (const std::uint16_t d : out.depth) {
    if (d == 0) continue;
    const double steps = kBaseline * kInfraredFocal / metres(d) / kDisparityStep;
    EXPECT_NEAR(steps, std::round(steps), 0.01);
  }
}

TEST(DepthSensor, NoiseOfNeighboursIsAlike) {
  const Image<float> noise = correlatedNoise(400, 300, 2, 11);
  double square = 0;
  double neighbour = 0;
  double far = 0;
  for (int v = 0; v < 300; ++v) {
    for (int u = 0; u < 380; ++u) {
      square += static_cast<double>(noise(u, v) * noise(u, v));
      neighbour += static_cast<double>(noise(u, v) * noise(u + 1, v));
      far += static_cast<double>(noise(u, v) * noise(u + 12, v));
    }
  }
  EXPECT_NEAR(square / (300 * 380), 1.0, 0.05);
  EXPECT_NEAR(neighbour / square, 0.8, 0.03);
  EXPECT_NEAR(far / square, 0.0, 0.05);
}

TEST(DepthSensor, RangeIsLimited) {
  for (const float z : {0.3F, 5.6F}) {
    for (const std::uint16_t d : senseDepth(wall(z), camera(), 1).depth) EXPECT_EQ(d, 0);
  }
}

TEST(DepthSensor, DarkAndGrazingSurfacesLeaveHoles) {
  DepthInput dark = wall(3.0F);
  for (float& r : dark.infrared) r = 0.05F;
  DepthInput slanted = wall(2.0F);
  for (float& c : slanted.cosine) c = 0.08F;
  const auto share = [](const DepthOutput& out) {
    int n = 0;
    for (const std::uint16_t d : out.depth) n += d > 0 ? 1 : 0;
    return n / (640.0 * 480.0);
  };
  EXPECT_LT(share(senseDepth(dark, camera(), 1)), 0.2);
  EXPECT_LT(share(senseDepth(slanted, camera(), 1)), 0.1);
  EXPECT_GT(share(senseDepth(wall(2.0F), camera(), 1)), 0.85);
}

TEST(DepthSensor, ANearBodyCastsAShadowToItsLeftAndIsLabelled) {
  DepthInput in = wall(3.0F);
  for (int v = 0; v < 480; ++v) {
    for (int u = 300; u < 420; ++u) {
      in.z(u, v) = 1.0F;
      in.body(u, v) = 1;
    }
  }
  const DepthOutput out = senseDepth(in, camera(), 3);
  // Disparities differ by 42.75 (1 - 1/3) = 28.5 px: so wide is the shadow.
  for (int v = 40; v < 440; v += 10) {
    for (int u = 278; u < 292; ++u) EXPECT_EQ(out.depth(u, v), 0) << u << ", " << v;
    EXPECT_EQ(out.mask(360, v), 2);
    EXPECT_EQ(out.mask(100, v), 1);
  }
  for (std::size_t i = 0; i < out.depth.size(); ++i) {
    EXPECT_EQ(out.depth[i] == 0, out.mask[i] == 0);
    if (out.mask[i] == 2) {
      EXPECT_LT(metres(out.depth[i]), 1.1);
    }
    if (out.mask[i] == 1) {
      EXPECT_GT(metres(out.depth[i]), 2.5);
    }
  }
}

TEST(DepthSensor, ThreadsDoNotChangeTheBytes) {
  const DepthOutput one = senseDepth(wall(2.0F), camera(), 5);
  setThreads(3);
  const DepthOutput three = senseDepth(wall(2.0F), camera(), 5);
  setThreads(1);
  EXPECT_EQ(one.depth, three.depth);
  EXPECT_NE(one.depth, senseDepth(wall(2.0F), camera(), 6).depth);
}

}  // namespace
}  // namespace rf::sim
