// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

Camera testCamera(int width, int height) {
  Camera c;
  c.width = width;
  c.height = height;
  c.fx = 0.8 * width;
  c.fy = 0.9 * width;
  c.cx = 0.5 * width;
  c.cy = 0.5 * height - 0.3;
  return c;
}

struct Frame {
  Image<Rgb> colour;
  Image<std::uint16_t> depth;
};

Frame noise(int width, int height, unsigned seed) {
  std::mt19937_64 random(seed);
  Frame f{Image<Rgb>(width, height), Image<std::uint16_t>(width, height)};
  for (std::size_t i = 0; i < f.depth.size(); ++i) {
    const auto bits = random();
    f.colour[i] = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
                   static_cast<std::uint8_t>(bits >> 16)};
    const bool hole = (bits >> 24) % 5 == 0;
    f.depth[i] = hole ? std::uint16_t{0} : static_cast<std::uint16_t>(1000 + (bits >> 32) % 300);
  }
  return f;
}

/// The definition (algorithm A.1), written without regard to speed.
RgbdLevel reference(const RgbdLevel& in, float gate) {
  RgbdLevel out{in.camera.reduced(2), {}, {}};
  out.intensity = Image<float>(out.camera.width, out.camera.height);
  out.depth = out.intensity;
  const std::array<double, 4> w = {1, 2, 2, 1};
  for (int v = 0; v < out.camera.height; ++v) {
    for (int u = 0; u < out.camera.width; ++u) {
      std::array<float, 4> four = {in.depth(2 * u, 2 * v), in.depth(2 * u + 1, 2 * v),
                                   in.depth(2 * u, 2 * v + 1), in.depth(2 * u + 1, 2 * v + 1)};
      const bool inner = u > 0 && v > 0 && 2 * u + 2 < in.camera.width - in.camera.width % 2 &&
                         2 * v + 2 < in.camera.height;
      if (!inner) {
        double i = 0, d = 0;
        int n = 0;
        for (int k = 0; k < 4; ++k) {
          i += in.intensity(2 * u + k % 2, 2 * v + k / 2) / 4;
          d += four[static_cast<std::size_t>(k)];
          n += four[static_cast<std::size_t>(k)] > 0;
        }
        out.intensity(u, v) = static_cast<float>(i);
        out.depth(u, v) = n ? static_cast<float>(d / n) : 0;
        continue;
      }
      std::sort(four.begin(), four.end());
      const float centre = four[2];
      double sw = 0, sd = 0, si = 0, plain = 0;
      for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
          const double m = w[static_cast<std::size_t>(x)] * w[static_cast<std::size_t>(y)] / 36;
          const float d = in.depth(2 * u - 1 + x, 2 * v - 1 + y);
          const float i = in.intensity(2 * u - 1 + x, 2 * v - 1 + y);
          plain += m * i;
          const double g = d > 0 ? m * std::max(0.0F, gate - std::abs(d - centre)) : 0.0;
          sw += g;
          sd += g * d;
          si += g * i;
        }
      }
      out.intensity(u, v) = static_cast<float>(centre > 0 ? si / sw : plain);
      out.depth(u, v) = static_cast<float>(centre > 0 ? sd / sw : 0.0);
    }
  }
  return out;
}

TEST(Pyramid, ReductionEqualsItsDefinition) {
  constexpr double kFloatRounding = 2e-5;
  for (const auto& [width, height] : {std::pair{64, 48}, {63, 47}, {65, 34}, {16, 16}}) {
    const Frame f = noise(width, height, 7);
    const RgbdLevel fine = reduceFrame(f.colour, f.depth, testCamera(width, height), 1, 0.3, 5.0);
    const RgbdLevel expected = reference(fine, 0.1F);
    const RgbdLevel direct = reduceFrame(f.colour, f.depth, testCamera(width, height), 2, 0.3, 5.0);
    const RgbdLevel twice = reduceByTwo(fine);
    ASSERT_EQ(direct.depth.width(), width / 2);
    EXPECT_TRUE(direct.camera == testCamera(width, height).reduced(2));
    for (std::size_t i = 0; i < expected.depth.size(); ++i) {
      ASSERT_NEAR(twice.depth[i], expected.depth[i], kFloatRounding) << width << " at " << i;
      ASSERT_NEAR(twice.intensity[i], expected.intensity[i], kFloatRounding) << width << " " << i;
      ASSERT_NEAR(direct.depth[i], expected.depth[i], kFloatRounding) << width << " at " << i;
      ASSERT_NEAR(direct.intensity[i], expected.intensity[i], kFloatRounding) << width << " " << i;
    }
  }
}

TEST(Pyramid, ConvertsLumaAndMetresAndCutsTheRange) {
  Frame f{Image<Rgb>(16, 16, {255, 0, 0}), Image<std::uint16_t>(16, 16, 1500)};
  f.colour(1, 0) = {0, 255, 0};
  f.colour(2, 0) = {0, 0, 255};
  f.colour(3, 0) = {255, 255, 255};
  f.depth(0, 0) = 299;
  f.depth(1, 0) = 300;
  f.depth(2, 0) = 4500;
  f.depth(3, 0) = 4501;
  const RgbdLevel level = reduceFrame(f.colour, f.depth, testCamera(16, 16), 1, 0.3, 4.5);
  EXPECT_NEAR(level.intensity(0, 0), 0.299, 1e-6);
  EXPECT_NEAR(level.intensity(1, 0), 0.587, 1e-6);
  EXPECT_NEAR(level.intensity(2, 0), 0.114, 1e-6);
  EXPECT_NEAR(level.intensity(3, 0), 1.0, 1e-6);
  EXPECT_EQ(level.depth(0, 0), 0.0F);
  EXPECT_NEAR(level.depth(1, 0), 0.3, 1e-6);
  EXPECT_NEAR(level.depth(2, 0), 4.5, 1e-6);
  EXPECT_EQ(level.depth(3, 0), 0.0F);
}

TEST(Pyramid, DepthEdgesStaySharp) {
  Frame f{Image<Rgb>(64, 48), Image<std::uint16_t>(64, 48)};
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const bool left = u < 31;
      f.depth(u, v) = left ? 1000 : 2000;
      f.colour(u, v) = left ? Rgb{0, 0, 0} : Rgb{255, 255, 255};
    }
  }
  for (int reduction : {2, 3, 4, 5}) {
    const RgbdLevel level = reduceFrame(f.colour, f.depth, testCamera(64, 48), reduction, 0.3, 5);
    // The border is a plain mean by definition.
    for (int v = 2; v < level.camera.height - 2; ++v) {
      for (int u = 2; u < level.camera.width - 2; ++u) {
        const float d = level.depth(u, v);
        ASSERT_TRUE(std::abs(d - 1) < 1e-5 || std::abs(d - 2) < 1e-5) << reduction << " " << d;
        ASSERT_NEAR(level.intensity(u, v), d < 1.5 ? 0.0 : 1.0, 1e-5) << reduction;
      }
    }
  }
}

TEST(Pyramid, AllInvalidDepthKeepsIntensity) {
  const Frame f{Image<Rgb>(64, 48, {255, 255, 255}), Image<std::uint16_t>(64, 48, 0)};
  for (int reduction : {1, 2, 3, 4}) {
    const RgbdLevel level = reduceFrame(f.colour, f.depth, testCamera(64, 48), reduction, 0.3, 5);
    for (float d : level.depth) ASSERT_EQ(d, 0.0F);
    for (float i : level.intensity) ASSERT_NEAR(i, 1.0F, 1e-5);
  }
}

TEST(Pyramid, StopsBeforeLevelsBecomeTooSmall) {
  const Frame f = noise(64, 48, 3);
  const auto pyramid =
      buildPyramid(reduceFrame(f.colour, f.depth, testCamera(64, 48), 2, 0.3, 5), 9);
  ASSERT_EQ(pyramid.size(), 2u);  // 32x24, 16x12; 8x6 would be too small
  EXPECT_EQ(pyramid.back().camera.width, 16);
}

TEST(Pyramid, SameBitsForEveryThreadCount) {
  const Frame f = noise(640, 480, 5);
  setThreads(1);
  const RgbdLevel one = reduceFrame(f.colour, f.depth, testCamera(640, 480), 4, 0.3, 5);
  setThreads(3);
  const RgbdLevel three = reduceFrame(f.colour, f.depth, testCamera(640, 480), 4, 0.3, 5);
  setThreads(1);
  EXPECT_TRUE(one.depth == three.depth);
  EXPECT_TRUE(one.intensity == three.intensity);
}

TEST(Pyramid, RefusesWhatItCannotReduce) {
  const Frame f = noise(64, 48, 1);
  Camera camera = testCamera(64, 48);
  EXPECT_THROW(reduceFrame(f.colour, f.depth, camera, 0, 0.3, 5), std::invalid_argument);
  EXPECT_THROW(reduceFrame(f.colour, f.depth, camera, 64, 0.3, 5), std::invalid_argument);
  EXPECT_THROW(reduceFrame(f.colour, f.depth, testCamera(32, 48), 2, 0.3, 5),
               std::invalid_argument);
  camera.distortion[0] = 0.1;
  EXPECT_THROW(reduceFrame(f.colour, f.depth, camera, 2, 0.3, 5), std::invalid_argument);
}

}  // namespace
}  // namespace rf
