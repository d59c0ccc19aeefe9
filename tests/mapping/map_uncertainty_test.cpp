// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_uncertainty.hpp"

#include <gtest/gtest.h>

#include "mapping/body_model.hpp"

namespace rf {
namespace {

constexpr int kEpoch = 8;  // frames; times below are far enough apart to be epochs of their own

Mat6 variance(double v) { return v * Mat6::Identity(); }

Camera smallCamera() { return {4, 1, 4, 4, 1.5, 0, {0, 0, 0, 0, 0}}; }

/// A map of one surfel for each time of birth, and a prediction that shows them by index.
class Seen {
 public:
  explicit Seen(const std::vector<int>& born) {
    for (const int t : born) {
      Surfel s;
      s.radius = 0.01F;
      s.born = t;
      ids_.push_back(map.append(s));
    }
  }
  Prediction show(const std::vector<std::size_t>& which) const {
    Prediction p = Prediction::nothing(smallCamera());
    for (std::size_t i = 0; i < which.size(); ++i) p.id[i] = ids_[which[i]];
    return p;
  }
  SurfelMap map;

 private:
  std::vector<std::uint32_t> ids_;
};

const Image<float> kAll(4, 1, 1.0F);

TEST(MapUncertainty, AnEmptyMapAddsNothing) {
  const MapUncertainty u;
  const Seen scene({1});
  EXPECT_TRUE(u.seen(scene.map, scene.show({0}), kAll).empty());
  EXPECT_EQ(u.of({}), Mat6(Mat6::Zero()));
}

TEST(MapUncertainty, TheMeanOfThePiecesCountsByTheirPixels) {
  const Seen scene({0, 2 * kEpoch});
  MapUncertainty u;
  u.fuse(0, {}, variance(1));
  u.fuse(2 * kEpoch, {}, variance(5));
  const auto seen = u.seen(scene.map, scene.show({0, 0, 0, 1}), kAll);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_NEAR(u.of(seen)(2, 2), 0.75 * 1 + 0.25 * 5, 1e-12);
  Image<float> weight = kAll;
  weight(0, 0) = weight(1, 0) = 0.0F;
  EXPECT_NEAR(u.of(u.seen(scene.map, scene.show({0, 0, 0, 1}), weight))(2, 2), 3, 1e-12);
  EXPECT_NEAR(u.of({})(2, 2), 5, 1e-12) << "nothing is seen: as the newest";
}

TEST(MapUncertainty, KnowsWhatCameBackIntoView) {
  constexpr int kLong = 100, kShort = 20;  // frames
  const Seen scene({0});
  MapUncertainty u;
  u.fuse(0, {}, variance(1));
  const auto seen = u.seen(scene.map, scene.show({0}), kAll);
  u.fuse(kShort, seen, variance(1));
  EXPECT_FALSE(u.cameBack(0)) << "a short absence is none";
  u.fuse(kShort + kLong, seen, variance(1));
  EXPECT_TRUE(u.cameBack(0));
  EXPECT_FALSE(u.cameBack(MapUncertainty::epochOf(kShort + kLong))) << "this is new";
  EXPECT_FALSE(u.cameBack(1000)) << "this is not yet there";
}

TEST(MapUncertainty, SharesACorrectionByWhatThePiecesMayBeOff) {
  const Seen scene({0});
  MapUncertainty u;
  u.fuse(0, {}, variance(0.5));
  const auto first = u.seen(scene.map, scene.show({0}), kAll);
  u.fuse(kEpoch, {}, variance(1));
  u.fuse(2 * kEpoch, {}, variance(3));
  u.fuse(20 * kEpoch, first, variance(0.5));  // the first pieces come back
  const std::vector<Mat6> gains = u.takeCorrection(variance(4), 1.0);
  ASSERT_EQ(gains.size(), 21U);
  EXPECT_EQ(gains[0], Mat6(Mat6::Zero()));
  EXPECT_NEAR(gains[1](4, 4), 1.0 / 4, 1e-12);
  EXPECT_NEAR(gains[2](4, 4), 3.0 / 4, 1e-12);
  const auto middle = std::vector<MapUncertainty::Share>{{2, 1.0}};
  EXPECT_NEAR(u.of(middle)(0, 0), 3 - 9.0 / 4, 1e-12) << "what the observation leaves";
}

// The camera moves on: each frame aligns to what the one before added.
TEST(MapUncertainty, NewSurfaceInheritsAndAddsAndOldSurfaceAnchors) {
  constexpr int kSteps = 20;
  std::vector<int> born;
  for (int k = 0; k <= kSteps; ++k) born.push_back(k * kEpoch);
  const Seen scene(born);
  MapUncertainty u;
  u.fuse(0, {}, variance(0));
  const double alignment = 0.3;
  for (int k = 1; k <= kSteps; ++k) {
    const auto seen = u.seen(scene.map, scene.show({static_cast<std::size_t>(k - 1)}), kAll);
    const Mat6 pose = u.of(seen) + variance(alignment);
    EXPECT_NEAR(pose(0, 0), alignment * k, 1e-9);
    u.fuse(k * kEpoch, {}, pose);
  }
  const auto home = u.seen(scene.map, scene.show({0}), kAll);
  EXPECT_NEAR(u.of(home)(0, 0), 0, 1e-12) << "back at the start the drift is gone";
}

TEST(MapUncertainty, SurfaceThatStaysInViewTakesTheMeanOfAllFrames) {
  const Seen scene({0});
  MapUncertainty u;
  u.fuse(0, {}, variance(0));
  double sum = 0;
  for (int n = 1; n < 50; ++n) {
    const auto seen = u.seen(scene.map, scene.show({0}), kAll);
    const double pose = u.of(seen)(0, 0) + 1.0;
    EXPECT_NEAR(u.of(seen)(0, 0), sum / n, 1e-9);
    sum += pose;
    u.fuse(0, seen, variance(pose));
  }
}

TEST(Perturbations, LeftAndRightDescribeTheSameErrors) {
  const SE3 T = SE3::exp((Vec6() << 1, 2, -1, 0.4, -0.3, 0.8).finished());
  Mat6 right = Mat6::Zero();
  right.diagonal() << 1, 2, 3, 4, 5, 6;
  EXPECT_LT((toRight(T, toLeft(T, right)) - right).norm(), 1e-12);
  // T exp(r) = exp(Ad r) T for one error.
  Vec6 r;
  r << 1e-4, 2e-4, -1e-4, 3e-4, 1e-4, -2e-4;
  const Mat6 left = toLeft(T, r * r.transpose());
  const Vec6 l = (T * SE3::exp(r) * T.inverse()).log();
  EXPECT_LT((left - l * l.transpose()).norm(), 1e-9);
}

}  // namespace
}  // namespace rf
