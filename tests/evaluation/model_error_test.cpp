// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/model_error.hpp"

#include <random>

#include <gtest/gtest.h>

#include "evaluation/point_index.hpp"

namespace rf {
namespace {

/// A square of 1 m in the plane z = height, one point per centimetre.
std::vector<SurfelPoint> square(float height, bool normals, int columns = 101) {
  std::vector<SurfelPoint> points;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j <= 100; ++j) {
      SurfelPoint p;
      p.x = 0.01F * static_cast<float>(i);
      p.y = 0.01F * static_cast<float>(j);
      p.z = height;
      p.nz = normals ? 1.0F : 0.0F;
      points.push_back(p);
    }
  }
  return points;
}

TEST(PointIndex, EqualsBruteForce) {
  std::mt19937_64 rng(5);
  const auto unit = [&] { return static_cast<float>(rng() >> 40) * 0x1p-24F; };
  std::vector<Eigen::Vector3f> cloud;
  for (int i = 0; i < 500; ++i) cloud.emplace_back(unit(), unit(), 0.1F * unit());
  const PointIndex index(cloud);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3f query(unit() * 1.5F, unit(), unit());
    float best = 0.3F;
    bool found = false;
    for (const Eigen::Vector3f& p : cloud) {
      const float d = (p - query).norm();
      if (d <= best) {
        best = d;
        found = true;
      }
    }
    const auto nearest = index.nearest(query, 0.3F);
    ASSERT_EQ(nearest.has_value(), found);
    if (found) {
      EXPECT_FLOAT_EQ(nearest->distance, best);
    }
  }
  EXPECT_FALSE(PointIndex({}).nearest({0, 0, 0}, 1).has_value());
  EXPECT_TRUE(PointIndex({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).nearest({0, 0, 0}, 0).has_value());
}

TEST(ModelScore, DistanceOfParallelPlanesIsTheirOffset) {
  for (const bool normals : {true, false}) {
    const ModelScore s = scoreModel(square(0.01F, normals), square(0, normals), SE3());
    EXPECT_NEAR(s.accuracy_median, 0.01, 1e-6);
    EXPECT_NEAR(s.accuracy_rmse, 0.01, 1e-6);
    EXPECT_EQ(s.accuracy_share, 1.0);
    EXPECT_EQ(s.completeness, 1.0);
    const ModelScore far = scoreModel(square(0.03F, normals), square(0, normals), SE3());
    EXPECT_EQ(far.accuracy_share, 0.0);
    EXPECT_EQ(far.completeness, 0.0);
  }
}

TEST(ModelScore, SpacingOfTruthIsNoErrorWhereItHasNormals) {
  std::vector<SurfelPoint> between = square(0, true);
  for (SurfelPoint& p : between) {
    p.x += 0.005F;
    p.y += 0.005F;
  }
  EXPECT_NEAR(scoreModel(between, square(0, true), SE3()).accuracy_median, 0, 1e-6);
  EXPECT_NEAR(scoreModel(between, square(0, false), SE3()).accuracy_median, 0.00707, 1e-4);
}

TEST(ModelScore, AlignsAndMeasuresCompleteness) {
  const SE3 T = SE3::exp((Vec6() << 1, 2, 3, 0.2, 0.3, 1.4).finished());
  std::vector<SurfelPoint> model = square(0, false, 51);  // half of the square
  for (SurfelPoint& p : model) {
    const Vec3 q = T.inverse() * Vec3(p.x, p.y, p.z);
    p.x = static_cast<float>(q.x());
    p.y = static_cast<float>(q.y());
    p.z = static_cast<float>(q.z());
  }
  const ModelScore s = scoreModel(model, square(0, true), T);
  EXPECT_LT(s.accuracy_median, 1e-5);
  EXPECT_NEAR(s.completeness, 53.0 / 101, 0.011) << "51 columns and those within 2 cm";
  EXPECT_EQ(scoreModel({}, square(0, true), SE3()).completeness, 0.0);
}

}  // namespace
}  // namespace rf
