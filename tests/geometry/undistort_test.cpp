// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/undistort.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

Camera distortedCamera() {
  Camera c;
  c.width = 320;
  c.height = 240;
  c.fx = 262;
  c.fy = 265;
  c.cx = 160.3;
  c.cy = 118.9;
  c.distortion = {0.2, -0.5, 0.002, -0.003, 0.4};
  return c;
}

/// A smooth pattern given on the ideal image plane.
double pattern(const Eigen::Vector2d& p) { return 120 + 0.3 * p.x() + 0.15 * p.y(); }

TEST(Undistort, WithoutDistortionCopies) {
  Camera c = distortedCamera().undistorted();
  Image<Rgb> colour(320, 240, {1, 2, 3});
  colour(5, 6) = {9, 8, 7};
  Image<std::uint16_t> depth(320, 240, 1234);
  const Undistorter u(c);
  EXPECT_TRUE(u.colour(colour) == colour);
  EXPECT_TRUE(u.depth(depth) == depth);
}

TEST(Undistort, RecoversAnIdealImage) {
  const Camera c = distortedCamera();
  Image<Rgb> colour(320, 240);
  Image<std::uint16_t> depth(320, 240);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const double value = pattern(c.undistort({u, v}));
      const auto byte = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
      colour(u, v) = {byte, static_cast<std::uint8_t>(byte / 2), 0};
      depth(u, v) = static_cast<std::uint16_t>(std::lround(value * 10));
    }
  }
  const Undistorter undistorter(c);
  const Image<Rgb> out = undistorter.colour(colour);
  const Image<std::uint16_t> z = undistorter.depth(depth);
  int outside = 0;
  for (int v = 2; v < 238; ++v) {
    for (int u = 2; u < 318; ++u) {
      if (z(u, v) == 0) {
        ++outside;
        continue;
      }
      // Rounding of the source (0.5) and of the blend (0.5); nearest: half a pixel of slope.
      ASSERT_NEAR(out(u, v).r, std::min(255.0, pattern({u, v})), 1.6) << u << " " << v;
      ASSERT_NEAR(z(u, v) / 10.0, pattern({u, v}), 0.35) << u << " " << v;
    }
  }
  EXPECT_LT(outside, 320 * 240 / 10);
}

TEST(Undistort, OutsideIsBlackAndWithoutDepth) {
  Camera c = distortedCamera();
  c.distortion = {0.5, 0, 0, 0, 0};  // corners look up far outside
  const Undistorter u(c);
  const Image<Rgb> colour = u.colour(Image<Rgb>(320, 240, {255, 255, 255}));
  const Image<std::uint16_t> depth = u.depth(Image<std::uint16_t>(320, 240, 1000));
  EXPECT_TRUE(colour(0, 0) == Rgb{});
  EXPECT_EQ(depth(0, 0), 0);
  EXPECT_TRUE(colour(160, 120) == (Rgb{255, 255, 255}));
  EXPECT_EQ(depth(160, 120), 1000);
}

TEST(Undistort, RefusesWrongSizesAndBadCalibrations) {
  const Undistorter u(distortedCamera());
  EXPECT_THROW(u.colour(Image<Rgb>(319, 240)), std::invalid_argument);
  EXPECT_THROW(u.depth(Image<std::uint16_t>()), std::invalid_argument);
  Camera bad = distortedCamera();
  bad.distortion[1] = std::nan("");
  EXPECT_THROW(Undistorter{bad}, std::invalid_argument);
}

}  // namespace
}  // namespace rf
