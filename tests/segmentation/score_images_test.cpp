// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/score_images.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr int kWidth = 40, kHeight = 30, kEdge = 20;  // dynamic left of the edge
constexpr float kDepth = 2.0F;
constexpr std::uint8_t kNoCluster = 255;

Camera camera() {
  Camera c;
  c.width = kWidth;
  c.height = kHeight;
  c.fx = c.fy = 40;
  c.cx = 19.5;
  c.cy = 14.5;
  return c;
}

TermLevel wall() {
  TermLevel level;
  level.camera = camera();
  level.depth = Image<float>(kWidth, kHeight, kDepth);
  return level;
}

/// Cluster 0 left of `edge`, 1 to the right of it.
Image<std::uint8_t> halves(int edge) {
  Image<std::uint8_t> label(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) label(u, v) = u < edge ? 0 : 1;
  }
  return label;
}

Image<std::uint8_t> previousScores() { return scoreImage(halves(kEdge), {0.0F, 1.0F}); }

/// A motion that shows this frame's pixel u at u + pixels in the last frame.
SE3 sideways(double pixels) {
  SE3 T;
  T.t = Vec3(pixels * static_cast<double>(kDepth) / camera().fx, 0, 0);
  return T;
}

ScorePrior warp(int edge, const SE3& step_s, const SE3& step_d) {
  return warpScores(previousScores(), camera(), wall(), halves(edge), 2, step_s, step_d);
}

TEST(WarpScores, FindTheOldScoresWhereNothingMoved) {
  const ScorePrior scores = warp(kEdge, SE3(), SE3());
  EXPECT_EQ(scores.target, (std::vector<float>{0.0F, 1.0F}));
  EXPECT_EQ(scores.weight, (std::vector<float>{1.0F, 1.0F}));
}

TEST(WarpScores, FollowTheMotion) {
  const ScorePrior scores = warp(kEdge - 5, sideways(5), sideways(5));
  EXPECT_EQ(scores.target, (std::vector<float>{0.0F, 1.0F}));
}

TEST(WarpScores, AreTheMeanOfBothMotions) {
  // By the second motion the ten columns left of the edge come from its right.
  const ScorePrior scores = warp(kEdge, SE3(), sideways(10));
  EXPECT_NEAR(scores.target[0], 10.0 / (2 * kEdge), 1e-6);
}

TEST(WarpScores, AreStaticWhereTheLastImageDoesNotReach) {
  const ScorePrior scores = warp(kEdge, sideways(kWidth), sideways(kWidth));
  EXPECT_EQ(scores.target, (std::vector<float>{1.0F, 1.0F}));
}

TEST(WarpScores, LeaveOutPixelsWithoutDepth) {
  TermLevel level = wall();
  level.depth = Image<float>(kWidth, kHeight);
  const ScorePrior scores =
      warpScores(previousScores(), camera(), level, halves(kEdge), 2, SE3(), SE3());
  EXPECT_EQ(scores.target, (std::vector<float>{1.0F, 1.0F}));
}

TEST(DynamicShare, CountsPixelsOfClusters) {
  Image<std::uint8_t> label = halves(10);
  EXPECT_DOUBLE_EQ(dynamicShare(label, {0.0F, 1.0F}), 0.25);
  for (std::uint8_t& k : label) k = k == 1 ? kNoCluster : k;
  EXPECT_DOUBLE_EQ(dynamicShare(label, {0.25F, 1.0F}), 0.75);
  EXPECT_DOUBLE_EQ(dynamicShare(label, {-3.0F, 1.0F}), 1.0);
  EXPECT_DOUBLE_EQ(dynamicShare(label, {}), 0.0);
}

TEST(ScoreImage, IsStaticWithoutClusterAndLimited) {
  Image<std::uint8_t> label(4, 1);
  label(1, 0) = 1;
  label(2, 0) = 2;
  label(3, 0) = kNoCluster;
  const Image<std::uint8_t> score = scoreImage(label, {-1.0F, 0.5F, 2.0F});
  EXPECT_EQ(score(0, 0), 0);
  EXPECT_EQ(score(1, 0), 128);
  EXPECT_EQ(score(2, 0), 255);
  EXPECT_EQ(score(3, 0), 255);
}

}  // namespace
}  // namespace rf
