// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/camera.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace rf {
namespace {

Camera freiburg1() {
  return {640, 480, 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
}
Camera bonn() {
  return {640, 480, 542.82, 542.58, 315.59, 237.76, {0.0399, -0.0993, -0.0007, -0.0001, 0}};
}

TEST(Camera, ProjectInvertsBackProject) {
  const Camera c = freiburg1();
  for (const double u : {-0.5, 0.0, 123.25, 639.0}) {
    for (const double v : {0.0, 77.5, 479.0}) {
      EXPECT_LT((c.project(c.backProject(u, v, 1.7)) - Eigen::Vector2d(u, v)).norm(), 1e-10);
    }
  }
  EXPECT_EQ(c.backProject(c.cx, c.cy, 2.0), Vec3(0, 0, 2)) << "z is forward";
}

TEST(Camera, UndistortInvertsDistortOverTheImage) {
  for (const Camera& c : {freiburg1(), bonn()}) {
    for (int v = 0; v < c.height; v += 16) {
      for (int u = 0; u < c.width; u += 16) {
        const Eigen::Vector2d p(u, v);
        EXPECT_LT((c.distort(c.undistort(p)) - p).norm(), 1e-5) << u << " " << v;
      }
    }
  }
}

TEST(Camera, DistortionFollowsOpenCvsFormula) {
  const Camera c = freiburg1();
  const double x = 0.4;
  const double y = -0.3;
  const double r2 = x * x + y * y;
  const double radial = 1 + 0.2624 * r2 - 0.9531 * r2 * r2 + 1.1633 * r2 * r2 * r2;
  const double xd = x * radial + 2 * -0.0054 * x * y + 0.0026 * (r2 + 2 * x * x);
  const double yd = y * radial + -0.0054 * (r2 + 2 * y * y) + 2 * 0.0026 * x * y;
  const Eigen::Vector2d expected(517.3 * xd + 318.6, 516.5 * yd + 255.3);
  EXPECT_LT((c.distort({517.3 * x + 318.6, 516.5 * y + 255.3}) - expected).norm(), 1e-10);
}

TEST(Camera, WithoutDistortionNothingMoves) {
  const Camera c = freiburg1().undistorted();
  EXPECT_FALSE(c.hasDistortion());
  EXPECT_TRUE(freiburg1().hasDistortion());
  EXPECT_LT((c.distort({10, 20}) - Eigen::Vector2d(10, 20)).norm(), 1e-12);
  EXPECT_LT((c.undistort({10, 20}) - Eigen::Vector2d(10, 20)).norm(), 1e-12);
}

TEST(Camera, ReductionKeepsRays) {
  const Camera c = freiburg1().undistorted();
  for (const int f : {2, 4, 8}) {
    const Camera r = c.reduced(f);
    EXPECT_EQ(r.width, 640 / f);
    EXPECT_EQ(r.height, 480 / f);
    // the centre of a reduced pixel is the centre of the block of f x f pixels that it covers
    const double u = f * 3 + (f - 1) / 2.0;
    const double v = f * 5 + (f - 1) / 2.0;
    EXPECT_LT((r.backProject(3, 5, 1) - c.backProject(u, v, 1)).norm(), 1e-12);
  }
}

TEST(Camera, ProblemsNameFieldValueAndRule) {
  EXPECT_FALSE(freiburg1().problem());
  const auto problem = [](auto change) {
    Camera c = freiburg1();
    change(c);
    return c.problem().value_or("none");
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(problem([](Camera& c) { c.width = 1; }).find("camera.width = 1"), std::string::npos);
  EXPECT_NE(problem([](Camera& c) { c.height = 40000; }).find("height"), std::string::npos);
  EXPECT_NE(problem([&](Camera& c) { c.fx = nan; }).find("fx"), std::string::npos);
  EXPECT_NE(problem([](Camera& c) { c.fy = -1; }).find("fy"), std::string::npos);
  EXPECT_NE(problem([](Camera& c) { c.cx = 640; }).find("cx"), std::string::npos);
  EXPECT_NE(problem([&](Camera& c) { c.cy = nan; }).find("cy"), std::string::npos);
  EXPECT_NE(problem([&](Camera& c) { c.distortion[4] = nan; }).find("distortion"),
            std::string::npos);
}

}  // namespace
}  // namespace rf
