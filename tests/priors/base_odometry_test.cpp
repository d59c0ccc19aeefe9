// SPDX-License-Identifier: BSD-3-Clause
#include "priors/base_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace rf {
namespace {

constexpr double kGap = 0.2;
constexpr double kBeyond = 0.1;
constexpr double kExact = 1e-9;  // a second of arcs, each exact to rounding

RobotConfig robot() { return {}; }

SE3 at(double x, double y, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), Vec3(x, y, 0)};
}

std::int64_t us(double seconds) { return std::llround(seconds * 1e6); }

PoseAt lookUp(const BaseOdometry& odometry, double seconds) {
  return odometry.at(us(seconds), kGap, kBeyond);
}

void expectSame(const SE3& a, const SE3& b, double tolerance) {
  EXPECT_LT((a.inverse() * b).log().norm(), tolerance)
      << a.t.transpose() << " and " << b.t.transpose();
}

TEST(PlanarTwist, ArcIsExact) {
  const double v = 0.4;
  const double w = 1.3;
  const double t = 2.0;
  const double r = v / w;
  expectSame(arc({v, 0, w}, t), at(r * std::sin(w * t), r * (1 - std::cos(w * t)), w * t), 1e-12);
  expectSame(arc({v, 0.1, 0}, t), at(0.8, 0.2, 0), 1e-12);
}

TEST(BaseOdometry, ConstantTwistGivesACircle) {
  BaseOdometry odometry(robot(), kGap);
  const double w = 0.8;
  const double r = 0.5 / w;
  for (int i = 0; i <= 50; ++i) EXPECT_EQ(odometry.addTwist(us(0.02 * i), {0.5, 0, w}), "");
  for (const double t : {0.0, 0.37, 0.5, 0.991}) {
    const PoseAt found = lookUp(odometry, t);
    EXPECT_EQ(found.state, PriorState::kValid);
    expectSame(found.pose, at(r * std::sin(w * t), r * (1 - std::cos(w * t)), w * t), kExact);
  }
}

TEST(BaseOdometry, BetweenTwistsTheirMeanHolds) {
  BaseOdometry odometry(robot(), kGap);
  // Speed grows evenly: half of a t^2, exact for the mean.
  for (int i = 0; i <= 10; ++i) odometry.addTwist(us(0.1 * i), {0.1 * i, 0, 0});
  EXPECT_NEAR(lookUp(odometry, 1.0).pose.t.x(), 0.5, kExact);
}

TEST(BaseOdometry, GapBetweenTwistsIsAHole) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i) odometry.addTwist(us(0.02 * i), {0.5, 0, 0});
  EXPECT_EQ(odometry.addTwist(us(0.7), {0.5, 0, 0}), "odometry has a hole of 0.500 s");
  odometry.addTwist(us(0.72), {0.5, 0, 0});
  EXPECT_EQ(lookUp(odometry, 0.4).state, PriorState::kMissing);
  EXPECT_EQ(odometry.flaw(us(0.1), us(0.15)), "");
  EXPECT_EQ(odometry.flaw(us(0.7), us(0.72)), "");
  EXPECT_EQ(odometry.flaw(us(0.18), us(0.71)), "odometry has a hole of 0.500 s");
}

TEST(BaseOdometry, ScalesApplyToIncrements) {
  RobotConfig config = robot();
  config.wheel_scale = 1.1;
  config.turn_scale = 0.9;
  BaseOdometry twists(config, kGap);
  BaseOdometry poses(config, kGap);
  SE3 T_WB = at(3, -2, 1);
  const SE3 start = T_WB;
  for (int i = 0; i <= 20; ++i) {
    twists.addTwist(us(0.05 * i), {0.5, 0, 0.8});
    poses.addPose(us(0.05 * i), T_WB);
    T_WB = T_WB * arc({0.5, 0, 0.8}, 0.05);
  }
  const SE3 expected = arc({0.55, 0, 0.72}, 1.0);
  expectSame(lookUp(twists, 1.0).pose, expected, kExact);
  expectSame(lookUp(poses, 1.0).pose, start * expected, kExact);
}

TEST(BaseOdometry, PosesPassUnchangedAndShiftedInTime) {
  RobotConfig config = robot();
  config.odometry_offset = -0.05;
  BaseOdometry odometry(config, kGap);
  for (int i = 0; i <= 10; ++i) odometry.addPose(us(0.1 * i), at(0.1 * i, 0.03 * i, 0.02 * i));
  const PoseAt found = lookUp(odometry, 0.35);
  EXPECT_EQ(found.state, PriorState::kValid);
  expectSame(found.pose, at(0.4, 0.12, 0.08), kExact);
}

TEST(BaseOdometry, IncrementsJoinEndToStart) {
  BaseOdometry odometry(robot(), kGap);
  const SE3 step = at(0.02, 0, 0.01);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(odometry.addIncrement(us(0.1 * i), us(0.1 * (i + 1)), step), "");
  SE3 expected;
  for (int i = 0; i < 10; ++i) expected = expected * step;
  expectSame(lookUp(odometry, 1.0).pose, expected, kExact);
  EXPECT_EQ(odometry.addIncrement(us(1.05), us(1.15), step), "odometry has a hole of 0.150 s");
  EXPECT_NE(odometry.flaw(us(1.0), us(1.1)), "");
  EXPECT_EQ(odometry.addIncrement(us(2), us(1), step), "it ends before it begins");
}

TEST(BaseOdometry, RefusesWhatIsNoPose) {
  BaseOdometry odometry(robot(), kGap);
  SE3 bad = at(0, 0, 0);
  bad.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(odometry.addPose(1, bad), "it is not finite");
  bad = at(0, 0, 0);
  bad.q.coeffs() *= 2;
  EXPECT_EQ(odometry.addPose(1, bad), "its quaternion has length 2, must be 1");
  EXPECT_EQ(odometry.addTwist(1, {NAN, 0, 0}), "it is not finite");
  EXPECT_EQ(odometry.addTwist(1, {4, 0, 0}), "its speed is 4 m/s, max_speed is 3");
  EXPECT_EQ(odometry.addTwist(1, {0, 0, -7}), "it turns at -7 rad/s, max_turn is 6");
  EXPECT_EQ(odometry.addPose(std::numeric_limits<std::int64_t>::max(), at(0, 0, 0)),
            "its time is absurd");
  EXPECT_EQ(odometry.counts().refused, 6);
  EXPECT_EQ(odometry.counts().accepted, 0);
}

TEST(BaseOdometry, JumpIsFlaggedAndWhatFollowsIsGoodAgain) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i) EXPECT_EQ(odometry.addPose(us(0.05 * i), at(0.01 * i, 0, 0)), "");
  EXPECT_EQ(odometry.addPose(us(0.55), at(2.1, 0, 0)),
            "odometry jumps by 2.000 m in 0.050 s (max_speed is 3 m/s)");
  EXPECT_NE(odometry.flaw(us(0.48), us(0.56)), "");  // extrapolated along the jump
  odometry.addPose(us(0.6), at(2.11, 0, 0));
  EXPECT_EQ(odometry.counts().jumps, 1);
  EXPECT_EQ(odometry.flaw(us(0.45), us(0.5)), "");
  EXPECT_NE(odometry.flaw(us(0.48), us(0.51)), "");
  EXPECT_NE(odometry.flaw(us(0.4), us(0.6)), "");
  EXPECT_NE(odometry.flaw(us(0.52), us(0.52)), "");
  EXPECT_EQ(odometry.flaw(us(0.55), us(0.6)), "");
  EXPECT_EQ(odometry.addPose(us(0.65), at(2.11, 0, 1)),
            "odometry jumps by 1.000 rad in 0.050 s (max_turn is 6 rad/s)");
}

TEST(BaseOdometry, FrozenPosesThatReportMotionAreFlagged) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i)
    odometry.addPose(us(0.05 * i), at(0.02 * i, 0, 0), StatedSpeed{0.4, 0});
  for (int i = 11; i <= 30; ++i) odometry.addPose(us(0.05 * i), at(0.2, 0, 0), StatedSpeed{0.4, 0});
  EXPECT_EQ(odometry.flaw(us(0.4), us(0.45)), "");
  EXPECT_EQ(odometry.flaw(us(0.55), us(0.6)), "");  // not yet for frozen_after
  EXPECT_EQ(odometry.flaw(us(1.0), us(1.05)),
            "odometry stands still for 0.550 s although it reports 0.400 m/s");
  EXPECT_NEAR(odometry.stillFor(us(1.0), us(1.05)).value(), 0.55, 1e-9);
}

TEST(BaseOdometry, RestIsNoFault) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 40; ++i) odometry.addPose(us(0.05 * i), at(1, 2, 3), StatedSpeed{0, 0});
  EXPECT_EQ(odometry.flaw(us(1.0), us(1.05)), "");
  BaseOdometry silent(robot(), kGap);  // says nothing of its speed
  for (int i = 0; i <= 40; ++i) silent.addPose(us(0.05 * i), at(1, 2, 3));
  EXPECT_EQ(silent.flaw(us(1.0), us(1.05)), "");
}

TEST(BaseOdometry, TimeThatStandsStillRunsDryWithAReason) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i) odometry.addPose(us(0.05 * i), at(0.01 * i, 0, 0));
  for (int i = 0; i < 7; ++i)
    EXPECT_EQ(odometry.addPose(us(0.5), at(0.2, 0, 0)), "it is not later than the sample before");
  EXPECT_EQ(lookUp(odometry, 0.55).state, PriorState::kExtrapolated);
  const PoseAt dry = lookUp(odometry, 0.7);
  EXPECT_EQ(dry.state, PriorState::kMissing);
  EXPECT_EQ(dry.reason,
            "0.200 s after the newest pose (limit 0.1 s) (7 samples since came with a time that "
            "does not advance)");
}

TEST(BaseOdometry, ClockThatGoesBackBeginsAnew) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i) odometry.addPose(us(100 + 0.05 * i), at(0.01 * i, 0, 0));
  for (int i = 0; i < Timeline::kRestartSamples - 1; ++i)
    EXPECT_EQ(odometry.addPose(us(0.05 * i), at(0, 0, 0)),
              "it is not later than the sample before");
  EXPECT_EQ(odometry.addPose(us(1), at(5, 0, 0)), "time went back: the odometry begins anew");
  EXPECT_EQ(odometry.addPose(us(1.05), at(5.01, 0, 0)), "");
  EXPECT_EQ(lookUp(odometry, 1.02).state, PriorState::kValid);
  EXPECT_EQ(odometry.flaw(us(1), us(1.05)), "");
  EXPECT_EQ(odometry.counts().restarts, 1);
}

TEST(BaseOdometry, OneStampAheadOfTimeDoesNotBlockForever) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i) odometry.addPose(us(0.05 * i), at(0.01 * i, 0, 0));
  odometry.addPose(us(1e9), at(0.1, 0, 0));
  for (int i = 11; i <= 20; ++i) odometry.addPose(us(0.05 * i), at(0.01 * i, 0, 0));
  EXPECT_EQ(lookUp(odometry, 0.95).state, PriorState::kValid);
}

TEST(BaseOdometry, LateSampleIsRefusedAndChangesNothing) {
  BaseOdometry odometry(robot(), kGap);
  for (int i = 0; i <= 10; ++i) odometry.addPose(us(0.05 * i), at(0.01 * i, 0, 0));
  for (int i = 0; i < 10; ++i) odometry.addPose(us(0.32), at(9, 9, 0));
  EXPECT_NEAR(lookUp(odometry, 0.4).pose.t.x(), 0.08, kExact);
  EXPECT_EQ(odometry.counts().restarts, 0);
}

}  // namespace
}  // namespace rf
