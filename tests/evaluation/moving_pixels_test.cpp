// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/moving_pixels.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;

Camera camera() {
  Camera c;
  c.width = kWidth;
  c.height = kHeight;
  c.fx = c.fy = 40;
  c.cx = 20;
  c.cy = 15;
  return c;
}

// A wall at `depth_m`; the columns from `first` on move.
MaskedDepth wall(double depth_m, int first, const SE3& T_WC = SE3()) {
  MaskedDepth frame{
      Image<std::uint8_t>(kWidth, kHeight, 1),
      Image<std::uint16_t>(kWidth, kHeight, static_cast<std::uint16_t>(1000.0 * depth_m + 0.5)),
      T_WC};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = first; u < kWidth; ++u) frame.truth(u, v) = 2;
  }
  return frame;
}

SurfelPoint surfel(double u, double v, double z) {
  const Vec3 p = camera().backProject(u, v, z);
  SurfelPoint s;
  s.x = static_cast<float>(p.x());
  s.y = static_cast<float>(p.y());
  s.z = static_cast<float>(p.z());
  return s;
}

TEST(MovingPixels, CountsWhatLiesOnDynamicPixelsAtTheirDepth) {
  const std::vector<SurfelPoint> map = {
      surfel(30, 10, 2.0),   surfel(30, 10, 2.019), surfel(30, 10, 2.021),
      surfel(30, 10, 1.979), surfel(10, 10, 2.0),  // static there
      surfel(50, 10, 2.0),                         // out of view
      surfel(30, 10, -2.0)                         // behind the camera
  };
  MovingPixels moving(map, camera());
  moving.add(wall(2.0, 20));
  const MapOnMoving r = moving.result();
  EXPECT_EQ(r.frames, 1U);
  EXPECT_EQ(r.surfels, map.size());
  EXPECT_EQ(r.on_moving, 2U);
  EXPECT_NEAR(r.share(), 2.0 / 7.0, 1e-12);
}

TEST(MovingPixels, CountsASurfelOnceOverAllFrames) {
  const std::vector<SurfelPoint> map = {surfel(30, 10, 2.0), surfel(10, 10, 2.0)};
  MovingPixels moving(map, camera());
  moving.add(wall(2.0, 20));
  moving.add(wall(2.0, 25));
  EXPECT_EQ(moving.result().on_moving, 1U);
  moving.add(wall(2.0, 0));
  EXPECT_EQ(moving.result().on_moving, 2U);
  EXPECT_EQ(moving.result().frames, 3U);
}

TEST(MovingPixels, LooksFromWhereTheCameraIs) {
  const std::vector<SurfelPoint> map = {surfel(30, 10, 2.0)};
  MovingPixels moving(map, camera());
  moving.add(wall(2.0, 20, SE3(Eigen::Quaterniond::Identity(), Vec3(0, 0, 0.5))));
  EXPECT_EQ(moving.result().on_moving, 0U)
      << "half a metre nearer the wall is half a metre behind it";
  moving.add(wall(1.5, 20, SE3(Eigen::Quaterniond::Identity(), Vec3(0, 0, 0.5))));
  EXPECT_EQ(moving.result().on_moving, 1U);
}

TEST(MovingPixels, PixelsWithoutDepthSayNothing) {
  const std::vector<SurfelPoint> map = {surfel(30, 10, 2.0)};
  MovingPixels moving(map, camera());
  moving.add(wall(0.0, 20));
  EXPECT_EQ(moving.result().on_moving, 0U);
  EXPECT_EQ(MapOnMoving{}.share(), 0.0);
}

TEST(MovingPixels, RefusesImagesOfAnotherSize) {
  const std::vector<SurfelPoint> map;
  MovingPixels moving(map, camera());
  MaskedDepth frame = wall(2.0, 20);
  frame.truth = Image<std::uint8_t>(kWidth, kHeight - 1);
  EXPECT_THROW(moving.add(frame), std::invalid_argument);
}

}  // namespace
}  // namespace rf
