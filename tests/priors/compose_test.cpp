// SPDX-License-Identifier: BSD-3-Clause
#include "priors/compose.hpp"

#include <random>

#include <gtest/gtest.h>

namespace rf {
namespace {

SE3 randomPose(std::mt19937_64& rng, double scale) {
  Vec6 xi;
  for (int i = 0; i < 6; ++i) {
    xi[i] = scale * (static_cast<double>(rng() >> 11) * 0x1p-52 - 1.0);
  }
  return SE3::exp(xi);
}

Mat6 diagonal(double a, double b) {
  Vec6 d;
  d << Vec3::Constant(a), Vec3::Constant(b);
  return d.asDiagonal();
}

MotionPrior pair(std::int64_t a, std::int64_t b, const SE3& T_WA, const SE3& T_WB, const SE3& T_XOa,
                 const SE3& T_XOb, ObjectPriorKind kind) {
  MotionPrior p;
  p.utime_a = a;
  p.utime_b = b;
  p.seq = b;
  p.camera = p.object = PriorState::kValid;
  p.T_CaCb = T_WA.inverse() * T_WB;
  p.T_WCb = T_WB;
  p.camera_cov = diagonal(1e-4, 4e-4);
  p.object_kind = kind;
  p.T_XOa = T_XOa;
  p.T_XOb = T_XOb;
  p.object_cov = diagonal(1e-6, 2e-6);
  return p;
}

SE3 objectIncrement(const MotionPrior& p) {
  return p.object_kind == ObjectPriorKind::kCameraFrame ? p.T_XOa * p.T_XOb.inverse()
                                                        : p.T_XOa.inverse() * p.T_XOb;
}

/// First-order covariance by central differences of the product of perturbed increments.
Mat6 numericCovariance(const SE3& T1, const Mat6& c1, const SE3& T2, const Mat6& c2) {
  constexpr double kStep = 1e-5;
  const SE3 inverse = (T1 * T2).inverse();
  Mat6 sum = Mat6::Zero();
  for (int which = 0; which < 2; ++which) {
    Mat6 jacobian;
    for (int i = 0; i < 6; ++i) {
      const Vec6 e = kStep * Vec6::Unit(i);
      const SE3 plus = which == 0 ? T1 * SE3::exp(e) * T2 : T1 * T2 * SE3::exp(e);
      const SE3 minus = which == 0 ? T1 * SE3::exp(-e) * T2 : T1 * T2 * SE3::exp(-e);
      jacobian.col(i) = ((inverse * plus).log() - (inverse * minus).log()) / (2 * kStep);
    }
    sum += jacobian * (which == 0 ? c1 : c2) * jacobian.transpose();
  }
  return sum;
}

TEST(ComposePriors, EqualsTheDirectPairWithFirstOrderCovariance) {
  std::mt19937_64 rng(7);
  for (const auto kind : {ObjectPriorKind::kWorldFrame, ObjectPriorKind::kCameraFrame}) {
    for (int i = 0; i < 20; ++i) {
      const SE3 T_WA = randomPose(rng, 1);
      const SE3 T_WB = T_WA * randomPose(rng, 0.3);
      const SE3 T_WC = T_WB * randomPose(rng, 0.3);
      const SE3 O_A = randomPose(rng, 1);
      const SE3 O_B = O_A * randomPose(rng, 0.3);
      const SE3 O_C = O_B * randomPose(rng, 0.3);
      const MotionPrior ab = pair(1, 2, T_WA, T_WB, O_A, O_B, kind);
      MotionPrior bc = pair(2, 3, T_WB, T_WC, O_B, O_C, kind);
      bc.self = {{RobotShapeKind::kSphere, Vec3(0.1, 0.1, 0.1), O_B}};
      const MotionPrior ac = composePriors(ab, bc);
      EXPECT_EQ(ac.utime_a, 1);
      EXPECT_EQ(ac.utime_b, 3);
      EXPECT_EQ(ac.seq, 3);
      EXPECT_LT((ac.T_CaCb.inverse() * T_WA.inverse() * T_WC).log().norm(), 1e-12);
      EXPECT_EQ(ac.self.size(), 1U);
      EXPECT_EQ(ac.self, bc.self);
      EXPECT_EQ(ac.T_WCb, T_WC);
      EXPECT_EQ(ac.T_XOa, O_A);
      EXPECT_EQ(ac.T_XOb, O_C);
      EXPECT_LT(
          (ac.camera_cov - numericCovariance(ab.T_CaCb, ab.camera_cov, bc.T_CaCb, bc.camera_cov))
              .norm(),
          1e-10);
      EXPECT_LT((ac.object_cov - numericCovariance(objectIncrement(ab), ab.object_cov,
                                                   objectIncrement(bc), bc.object_cov))
                    .norm(),
                1e-10);
    }
  }
}

TEST(ComposePriors, KeepsTheWorstState) {
  const SE3 I;
  MotionPrior ab = pair(1, 2, I, I, I, I, ObjectPriorKind::kWorldFrame);
  MotionPrior bc = pair(2, 3, I, I, I, I, ObjectPriorKind::kWorldFrame);
  ab.camera = PriorState::kExtrapolated;
  bc.object = PriorState::kMissing;
  const MotionPrior ac = composePriors(ab, bc);
  EXPECT_EQ(ac.camera, PriorState::kExtrapolated);
  EXPECT_EQ(ac.object, PriorState::kMissing);
  bc.object = PriorState::kValid;
  bc.object_kind = ObjectPriorKind::kCameraFrame;
  EXPECT_EQ(composePriors(ab, bc).object, PriorState::kMissing);
  bc.utime_a = 5;
  EXPECT_THROW(composePriors(ab, bc), std::invalid_argument);
}

}  // namespace
}  // namespace rf
