// SPDX-License-Identifier: BSD-3-Clause
#include "priors/pose_buffer.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr double kGap = 0.2;
constexpr double kBeyond = 0.1;

SE3 at(double x) { return {Eigen::Quaterniond::Identity(), Vec3(x, 0, 0)}; }

TEST(PoseBuffer, RejectsBadPosesWithCountedReasons) {
  PoseBuffer buffer;
  EXPECT_EQ(buffer.add(1000, at(0)), PoseVerdict::kAccepted);
  EXPECT_EQ(buffer.add(2000, at(std::numeric_limits<double>::quiet_NaN())),
            PoseVerdict::kNotFinite);
  EXPECT_EQ(buffer.add(2000, SE3(Eigen::Quaterniond(0, 0, 0, 0), Vec3::Zero())),
            PoseVerdict::kNotUnit);
  EXPECT_EQ(buffer.add(2000, SE3(Eigen::Quaterniond(1.1, 0, 0, 0), Vec3::Zero())),
            PoseVerdict::kNotUnit);
  EXPECT_EQ(buffer.add(1000, at(1)), PoseVerdict::kNotLater);
  EXPECT_EQ(buffer.add(500, at(1)), PoseVerdict::kNotLater);
  EXPECT_EQ(buffer.counts().accepted, 1);
  EXPECT_EQ(buffer.counts().not_finite, 1);
  EXPECT_EQ(buffer.counts().not_unit, 2);
  EXPECT_EQ(buffer.counts().not_later, 2);
}

TEST(PoseBuffer, IsBounded) {
  PoseBuffer buffer(3);
  for (int i = 0; i < 10; ++i) buffer.add(i * 1000, at(i));
  EXPECT_EQ(buffer.size(), 3U);
  EXPECT_EQ(buffer.oldest(), 7000);
  EXPECT_EQ(buffer.counts().evicted, 7);
}

TEST(PoseBuffer, InterpolatesOnTheGeodesic) {
  PoseBuffer buffer;
  const SE3 a = SE3::exp((Vec6() << 1, 2, 3, 0.1, 0.2, 0.3).finished());
  const Vec6 d = (Vec6() << 0.2, -0.1, 0.05, 0.3, -0.2, 0.1).finished();
  buffer.add(0, a);
  buffer.add(100000, a * SE3::exp(d));
  const PoseAt p = buffer.at(25000, kGap, kBeyond);
  EXPECT_EQ(p.state, PriorState::kValid);
  EXPECT_TRUE(p.reason.empty());
  EXPECT_LT((p.pose.inverse() * a * SE3::exp(0.25 * d)).log().norm(), 1e-12);
  EXPECT_EQ(buffer.at(100000, kGap, kBeyond).pose, buffer.at(100000, 1e-9, 0).pose);
}

TEST(PoseBuffer, FlagsWhatIsNotCovered) {
  PoseBuffer buffer;
  EXPECT_EQ(buffer.at(0, kGap, kBeyond).reason, "no pose received");
  buffer.add(0, at(0));
  EXPECT_EQ(buffer.at(50000, kGap, kBeyond).state, PriorState::kMissing) << "velocity unknown";
  buffer.add(100000, at(0.1));
  buffer.add(900000, at(0.9));
  buffer.add(1000000, at(1.0));
  EXPECT_EQ(buffer.at(500000, kGap, kBeyond).state, PriorState::kMissing);
  EXPECT_EQ(buffer.at(500000, kGap, kBeyond).reason, "gap of 0.800 s between poses (limit 0.2 s)");
  const PoseAt late = buffer.at(1050000, kGap, kBeyond);
  EXPECT_EQ(late.state, PriorState::kExtrapolated);
  EXPECT_NEAR(late.pose.t.x(), 1.05, 1e-12);
  EXPECT_EQ(late.reason, "0.050 s after the newest pose");
  const PoseAt early = buffer.at(-50000, kGap, kBeyond);
  EXPECT_EQ(early.state, PriorState::kExtrapolated);
  EXPECT_NEAR(early.pose.t.x(), -0.05, 1e-12);
  EXPECT_EQ(buffer.at(1200000, kGap, kBeyond).state, PriorState::kMissing);
  EXPECT_EQ(buffer.at(-200000, kGap, kBeyond).state, PriorState::kMissing);
}

}  // namespace
}  // namespace rf
