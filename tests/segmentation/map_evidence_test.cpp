// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/map_evidence.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;

Camera camera() {
  Camera c;
  c.width = kWidth;
  c.height = kHeight;
  c.fx = c.fy = 70;
  c.cx = 39.5;
  c.cy = 29.5;
  return c;
}

/// A wall at 3 m as the static model, and in the left third the body's model at 1 m.
MapView wallAndBody() {
  MapView map{camera(), Image<std::uint16_t>(kWidth, kHeight),
              Image<std::uint8_t>(kWidth, kHeight)};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      map.depth_mm(u, v) = u < kWidth / 3 ? 1000 : 3000;
      map.body(u, v) = u < kWidth / 3 ? kBodyObject : kBodyStatic;
    }
  }
  return map;
}

Image<float> plane(float z) {
  Image<float> depth(kWidth, kHeight);
  for (float& d : depth) d = z;
  return depth;
}

Image<MapWitness> witnessesAt(float z, const SE3& T_static = {}, const SE3& T_object = {}) {
  return mapWitnesses(wallAndBody(), camera(), plane(z), T_static, T_object, {}, {});
}

SE3 shifted(double x, double z) {
  SE3 T;
  T.t = Vec3(x, 0, z);
  return T;
}

TEST(MapWitnesses, NameTheModelWhoseSurfaceAPixelLiesOn) {
  EXPECT_EQ(witnessesAt(3.0F)(60, 30), MapWitness::kStatic);
  EXPECT_EQ(witnessesAt(1.0F)(10, 30), MapWitness::kObject);
}

TEST(MapWitnesses, CallASurfaceInFreeSpaceAnIntruder) {
  EXPECT_EQ(witnessesAt(1.0F)(60, 30), MapWitness::kIntruder);
}

TEST(MapWitnesses, SayNothingBehindTheModelOrWithoutDepth) {
  EXPECT_EQ(witnessesAt(3.6F)(60, 30), MapWitness::kNone);
  EXPECT_EQ(witnessesAt(0.0F)(60, 30), MapWitness::kNone);
}

TEST(MapWitnesses, FollowTheMotionOfEachBody) {
  // The camera went 0.5 m towards the wall: what is 2.5 m away now lies on it.
  EXPECT_EQ(witnessesAt(2.5F, shifted(0, 0.5))(60, 30), MapWitness::kStatic);
  EXPECT_NE(witnessesAt(2.5F)(60, 30), MapWitness::kStatic);
  // The body came 0.2 m nearer.
  EXPECT_EQ(witnessesAt(0.8F, {}, shifted(0, 0.2))(10, 30), MapWitness::kObject);
}

/// One cluster over the whole image.
Image<std::uint8_t> oneCluster() { return Image<std::uint8_t>(kWidth, kHeight); }

Image<MapWitness> all(MapWitness w) { return Image<MapWitness>(kWidth, kHeight, w); }

TEST(MapEvidence, PullsAClusterToTheModelThatExplainsIt) {
  ScorePrior scores{{0.0F}, {1.0F}};
  addMapEvidence(all(MapWitness::kStatic), oneCluster(), {0.0}, {}, scores);
  EXPECT_FLOAT_EQ(scores.weight[0], 2.0F);
  EXPECT_FLOAT_EQ(scores.target[0], 0.5F);
  scores = {{1.0F}, {1.0F}};
  addMapEvidence(all(MapWitness::kObject), oneCluster(), {0.0}, {}, scores);
  EXPECT_FLOAT_EQ(scores.target[0], 0.5F);
}

TEST(MapEvidence, IsSilentAboutTheStaticModelWhereMotionWasSeen) {
  ScorePrior scores{{0.0F}, {1.0F}};
  addMapEvidence(all(MapWitness::kStatic), oneCluster(), {5.0}, {}, scores);
  EXPECT_FLOAT_EQ(scores.weight[0], 1.0F);
  EXPECT_FLOAT_EQ(scores.target[0], 0.0F);
}

TEST(MapEvidence, IsSilentAboutTheBodyWhereRestWasSeen) {
  // A wall that slid in its own plane through the body's model keeps fitting that model's depth.
  ScorePrior scores{{1.0F}, {1.0F}};
  addMapEvidence(all(MapWitness::kObject), oneCluster(), {-5.0}, {}, scores);
  EXPECT_FLOAT_EQ(scores.weight[0], 1.0F);
  EXPECT_FLOAT_EQ(scores.target[0], 1.0F);
  const auto score = refineScores(all(MapWitness::kObject), plane(2.0F), oneCluster(), {1.0F},
                                  {-5.0}, Adjacency(1), {});
  EXPECT_EQ(score(40, 30), 255);
}

TEST(MapEvidence, LeavesClustersAloneThatNoModelKnows) {
  ScorePrior scores{{0.3F}, {1.0F}};
  addMapEvidence(all(MapWitness::kNone), oneCluster(), {0.0}, {}, scores);
  EXPECT_FLOAT_EQ(scores.weight[0], 1.0F);
  EXPECT_FLOAT_EQ(scores.target[0], 0.3F);
}

TEST(RefineScores, MendsAClusterThatReachesOverAContact) {
  // Dynamic cluster, the lower half of which is floor that the static model knows.
  Image<MapWitness> witnesses = all(MapWitness::kObject);
  for (int v = kHeight / 2; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) witnesses(u, v) = MapWitness::kStatic;
  }
  const auto score =
      refineScores(witnesses, plane(2.0F), oneCluster(), {0.0F}, {0.0}, Adjacency(1), {});
  EXPECT_LT(score(40, 10), 64);
  EXPECT_GT(score(40, 50), 160);
}

TEST(RefineScores, IntrudersCountOnlyBesideADynamicCluster) {
  Image<std::uint8_t> label = oneCluster();
  for (int v = 0; v < kHeight; ++v) {
    for (int u = kWidth / 2; u < kWidth; ++u) label(u, v) = 1;
  }
  Adjacency apart(2);
  Adjacency touching(2);
  touching.join(0, 1);
  const auto scoreOf = [&](const Adjacency& a) {
    return refineScores(all(MapWitness::kIntruder), plane(2.0F), label, {0.0F, 1.0F}, {0.0, 0.0}, a,
                        {})(70, 30);
  };
  EXPECT_EQ(scoreOf(apart), 255);
  EXPECT_LT(scoreOf(touching), 255);
}

TEST(MapEnergy, IsLeastForTheRightLabelsAndMotions) {
  TermLevel b;
  b.camera = camera();
  b.depth = Image<float>(kWidth, kHeight);
  Image<std::uint8_t> label(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const bool body = u < kWidth / 3;
      b.depth(u, v) = body ? 1.0F : 3.0F;
      label(u, v) = body ? 0 : 1;
    }
  }
  const std::vector<float> right = {0.0F, 1.0F};
  const std::vector<float> swapped = {1.0F, 0.0F};
  const auto energy = [&](const std::vector<float>& gamma, const SE3& T_static) {
    return mapEnergy(wallAndBody(), b, label, {T_static, SE3(), &gamma}, {}, {}, 1.0);
  };
  EXPECT_LT(energy(right, {}), 0.01);
  EXPECT_GT(energy(swapped, {}), energy(right, {}) + 0.5);
  EXPECT_GT(energy(right, shifted(0, 0.3)), energy(right, {}) + 0.5);
}

TEST(MapEnergy, ANoisySensorDoesNotMakeTheWorldUnknown) {
  TermLevel b;
  b.camera = camera();
  b.depth = plane(3.0F);
  Image<std::uint8_t> label(kWidth, kHeight, 0);
  const std::vector<float> world = {1.0F};
  const std::vector<float> unknown = {0.0F};
  const SE3 three_sigma = shifted(0, 0.07);
  const double noise = mapNoise(wallAndBody(), b, three_sigma, {}, {});
  EXPECT_GT(noise, 2.0);
  const auto energy = [&](const std::vector<float>& gamma, double factor) {
    const MapReading reading{three_sigma, three_sigma, &gamma, factor};
    return mapEnergy(wallAndBody(), b, label, reading, {}, {}, 1.0);
  };
  EXPECT_GT(energy(world, 1.0), energy(unknown, 1.0)) << "three times the stated noise";
  EXPECT_LT(energy(world, noise), energy(unknown, noise));
  EXPECT_EQ(mapNoise(wallAndBody(), b, {}, {}, {}), 1.0);
}

}  // namespace
}  // namespace rf
