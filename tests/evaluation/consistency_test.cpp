// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/consistency.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace rf {
namespace {

Vec6 twist(double vx, double vy, double vz, double wx, double wy, double wz) {
  return (Vec6() << vx, vy, vz, wx, wy, wz).finished();
}

ErrorSample sample(const Vec6& error, const Mat6& P, Health health = Health::kTracked) {
  return {error, {1, health, P}};
}

Mat6 diagonal(double sigma_m, double sigma_rad) {
  const double v = sigma_m * sigma_m;
  const double w = sigma_rad * sigma_rad;
  return Mat6(twist(v, v, v, w, w, w).asDiagonal());
}

TEST(Nees, HasTheClosedFormOfADiagonalCovariance) {
  const Mat6 P = diagonal(0.01, 0.002);
  // 1, 2, 2 sigma of translation, 3 sigma of rotation: 9 and 9 of 3 degrees of freedom each.
  const std::vector<ErrorSample> samples = {sample(twist(0.01, 0.02, 0.02, 0.006, 0, 0), P),
                                            sample(Vec6::Zero(), P)};
  const Consistency c = scoreConsistency(samples);
  EXPECT_EQ(c.samples, 2U);
  EXPECT_NEAR(c.pose.mean, 0.5 * 18.0 / 6.0, 1e-12);
  EXPECT_NEAR(c.translation.mean, 0.5 * 9.0 / 3.0, 1e-12);
  EXPECT_NEAR(c.rotation.mean, 0.5 * 9.0 / 3.0, 1e-12);
  EXPECT_DOUBLE_EQ(c.pose.share_above_95, 0.5) << "18 > 12.59";
  EXPECT_DOUBLE_EQ(c.translation.share_above_95, 0.5) << "9 > 7.81";
}

TEST(Nees, CorrelationsCount) {
  Mat6 P = diagonal(1, 1);
  P(0, 4) = P(4, 0) = 0.8;
  // For two variables of unit variance: (a^2 - 2 r a b + b^2) / (1 - r^2).
  const Consistency along = scoreConsistency({sample(twist(1, 0, 0, 0, 1, 0), P)});
  const Consistency across = scoreConsistency({sample(twist(1, 0, 0, 0, -1, 0), P)});
  EXPECT_NEAR(6 * along.pose.mean, (2 - 1.6) / 0.36, 1e-9);
  EXPECT_NEAR(6 * across.pose.mean, (2 + 1.6) / 0.36, 1e-9);
  EXPECT_NEAR(along.translation.mean, across.translation.mean, 1e-12);
}

TEST(Nees, ErrorsDrawnFromTheCovarianceAverageOne) {
  Mat6 A = Mat6::Zero();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) A(r, c) = (r < 3 ? 0.01 : 0.001) * normal(random);
  }
  const Mat6 P = A * A.transpose();
  std::vector<ErrorSample> samples;
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    Vec6 x;
    for (int k = 0; k < 6; ++k) x(k) = normal(random);
    samples.push_back(sample(A * x, P));
  }
  const Consistency c = scoreConsistency(samples);
  // The mean of chi-squared / 6 over n draws has a standard deviation of sqrt(2 / (6 n)) = 0.009.
  EXPECT_NEAR(c.pose.mean, 1.0, 0.04);
  EXPECT_NEAR(c.translation.mean, 1.0, 0.06);
  EXPECT_NEAR(c.rotation.mean, 1.0, 0.06);
  EXPECT_NEAR(c.pose.share_above_95, 0.05, 0.015);
}

TEST(Nees, ATrackedPoseFarOffIsAFailure) {
  const Mat6 P = diagonal(0.01, 0.01);
  const Vec6 far = twist(0.08, 0.08, 0, 0, 0, 0);
  const Consistency c =
      scoreConsistency({sample(far, P), sample(far, P, Health::kDegraded), sample(0.5 * far, P),
                        sample(far, P, Health::kPriorOnly)});
  EXPECT_EQ(c.tracked, 2U);
  EXPECT_EQ(c.misplaced, 1U);
}

TEST(Nees, ImpossibleCovariancesAreRefused) {
  Mat6 P = diagonal(0.01, 0.01);
  P(2, 2) = 0;
  EXPECT_THROW(scoreConsistency({sample(Vec6::Zero(), P)}), std::invalid_argument);
  P = diagonal(1, 1);
  P(0, 1) = P(1, 0) = 1.5;
  EXPECT_THROW(scoreConsistency({sample(Vec6::Zero(), P)}), std::invalid_argument);
}

TEST(ErrorSamples, UndoWorldAndOffsetAndLeaveTheFirstPairOut) {
  const SE3 world = SE3::exp(twist(1, 2, 3, 0.3, -0.2, 1));
  const SE3 offset = SE3::exp(twist(-0.3, 0.1, 0.2, 1, 0.5, 0.2));
  const Vec6 error = twist(0.01, -0.02, 0.03, 0.004, 0.005, -0.006);
  std::vector<PosePair> pairs;
  PoseCovariances covariances;
  for (int i = 0; i < 5; ++i) {
    const SE3 estimate = SE3::exp(twist(0.1 * i, 0, 0.2, 0, 0.1 * i, 0));
    const SE3 e = i == 0 ? SE3() : SE3::exp(error);
    pairs.push_back({i, estimate, world * estimate * e * offset});
    if (i != 3) covariances.push_back({i, Health::kTracked, Mat6::Identity()});
  }
  const std::vector<ErrorSample> samples = errorSamples(pairs, covariances, world, offset);
  ASSERT_EQ(samples.size(), 3U) << "neither the first nor the one without covariance";
  for (const ErrorSample& s : samples) EXPECT_LT((s.error - error).norm(), 1e-12);
  EXPECT_EQ(samples[2].claim.utime, 4);
}

}  // namespace
}  // namespace rf
