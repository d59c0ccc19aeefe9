// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/border_sides.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "values/segmentation_result.hpp"

namespace rf {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr std::uint8_t kWall = 0;
constexpr std::uint8_t kBox = 1;

/// A box of 10x10 pixels, 1.5 m away, before a wall; to its left a shadow without depth.
struct BoxAndWall {
  explicit BoxAndWall(float wall_m, int shadow)
      : depth(kWidth, kHeight, wall_m), label(kWidth, kHeight, kWall) {
    for (int v = 10; v < 20; ++v) {
      for (int u = 15; u < 25; ++u) {
        depth(u, v) = 1.5F;
        label(u, v) = kBox;
      }
      for (int u = 15 - shadow; u < 15; ++u) {
        depth(u, v) = 0;
        label(u, v) = kNoCluster;
      }
    }
  }
  Image<float> depth;
  Image<std::uint8_t> label;
};

TEST(BorderSides, ABoxThatMovesIsTheNearerSide) {
  const BoxAndWall scene(3.0F, 3);
  const BorderSides sides = borderSides(scene.depth, scene.label, {1.0F, 0.0F});
  EXPECT_EQ(sides.body_nearer, 40);
  EXPECT_EQ(sides.body_farther, 0);
  EXPECT_EQ(bodyBehind(sides), 0.0);
}

TEST(BorderSides, AWallThatMovesIsTheFartherSide) {
  const BoxAndWall scene(3.0F, 3);
  const BorderSides sides = borderSides(scene.depth, scene.label, {0.0F, 1.0F});
  EXPECT_EQ(sides.body_nearer, 0);
  EXPECT_EQ(sides.body_farther, 40);
  EXPECT_NEAR(bodyBehind(sides), std::log(5.0), 1e-12);
}

TEST(BorderSides, ABroadGapOrASmallStepSaysNothing) {
  const BoxAndWall gap(3.0F, 4);
  EXPECT_EQ(borderSides(gap.depth, gap.label, {1.0F, 0.0F}).body_nearer, 30);
  const BoxAndWall touching(1.55F, 0);
  const BorderSides sides = borderSides(touching.depth, touching.label, {1.0F, 0.0F});
  EXPECT_EQ(sides.body_nearer + sides.body_farther, 0);
}

TEST(BorderSides, AShortBorderSaysLittle) {
  EXPECT_EQ(bodyBehind({0, 0}), 0.0);
  EXPECT_LT(bodyBehind({0, 3}), 0.3);
  EXPECT_GT(bodyBehind({10, 100}), 1.5);
}

TEST(BorderSides, LeavesOutLabelsThatAreNoCluster) {
  BoxAndWall scene(3.0F, 0);
  for (std::uint8_t& l : scene.label) {
    if (l == kBox) l = 7;
  }
  const BorderSides sides = borderSides(scene.depth, scene.label, {1.0F, 0.0F});
  EXPECT_EQ(sides.body_nearer + sides.body_farther, 0);
}

}  // namespace
}  // namespace rf
