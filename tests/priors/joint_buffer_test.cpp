// SPDX-License-Identifier: BSD-3-Clause
#include "priors/joint_buffer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rf {
namespace {

constexpr double kGap = 0.2;
constexpr double kBeyond = 0.1;
using Names = std::vector<std::string>;
using Numbers = std::vector<double>;

JointBuffer buffer(double offset = 0) {
  return JointBuffer({{"pan", JointKind::kRevolute},
                      {"wheel", JointKind::kContinuous},
                      {"lift", JointKind::kPrismatic}},
                     20, offset);
}

std::int64_t us(double seconds) { return std::llround(seconds * 1e6); }

TEST(JointBuffer, InterpolatesAndExtrapolates) {
  JointBuffer joints = buffer();
  const Names names{"pan", "lift", "unknown"};
  for (int i = 0; i <= 10; ++i)
    EXPECT_EQ(joints.add(us(0.1 * i), names, Numbers{0.1 * i, 0.02 * i, 7}), "");
  const Names wanted{"pan", "lift"};
  const JointsAt mid = joints.at(us(0.55), wanted, kGap, kBeyond);
  EXPECT_EQ(mid.state, PriorState::kValid);
  EXPECT_NEAR(mid.q.at("pan"), 0.55, 1e-12);
  EXPECT_NEAR(mid.q.at("lift"), 0.11, 1e-12);
  const JointsAt beyond = joints.at(us(1.05), wanted, kGap, kBeyond);
  EXPECT_EQ(beyond.state, PriorState::kExtrapolated);
  EXPECT_EQ(beyond.reason, "joint 'lift': 0.050 s after the newest sample");
  EXPECT_NEAR(beyond.q.at("pan"), 1.05, 1e-12);
  const JointsAt late = joints.at(us(1.2), wanted, kGap, kBeyond);
  EXPECT_EQ(late.state, PriorState::kMissing);
  EXPECT_EQ(late.reason, "joint 'pan': 0.200 s after the newest sample (limit 0.1 s)");
  EXPECT_TRUE(joints.covers(us(1.0), wanted));
  EXPECT_FALSE(joints.covers(us(1.01), wanted));
}

TEST(JointBuffer, NoJointsWantedIsAlwaysValid) {
  EXPECT_EQ(buffer().at(5, Names{}, kGap, kBeyond).state, PriorState::kValid);
}

TEST(JointBuffer, ContinuousJointsGoTheShortWayRound) {
  JointBuffer joints = buffer();
  const double pi = std::numbers::pi;
  joints.add(0, Names{"wheel"}, Numbers{pi - 0.1});
  EXPECT_EQ(joints.add(us(0.1), Names{"wheel"}, Numbers{-pi + 0.1}), "");
  const JointsAt mid = joints.at(us(0.05), Names{"wheel"}, kGap, kBeyond);
  EXPECT_NEAR(std::remainder(mid.q.at("wheel") - pi, 2 * pi), 0, 1e-12);
  EXPECT_NEAR(joints.at(us(0.15), Names{"wheel"}, kGap, kBeyond).q.at("wheel"), pi + 0.2, 1e-12);
}

TEST(JointBuffer, ArmAndHeadMayComeApart) {
  JointBuffer joints = buffer();
  for (int i = 0; i <= 10; ++i) {
    EXPECT_EQ(joints.add(us(0.1 * i), Names{"pan"}, Numbers{0.1 * i}), "");
    EXPECT_EQ(joints.add(us(0.1 * i + 0.03), Names{"lift"}, Numbers{0.01 * i}), "");
  }
  EXPECT_EQ(joints.at(us(0.5), Names{"pan", "lift"}, kGap, kBeyond).state, PriorState::kValid);
}

TEST(JointBuffer, SaysWhatIsWrong) {
  JointBuffer joints = buffer();
  EXPECT_EQ(joints.add(1, Names{"a", "b"}, Numbers{1, 2}),
            "it has none of the joints lift, pan, wheel; it has a, b");
  EXPECT_EQ(joints.add(1, Names{}, Numbers{}),
            "it has none of the joints lift, pan, wheel; it has none at all");
  EXPECT_EQ(joints.add(1, Names{"pan", "lift"}, Numbers{1}), "it has 2 names and 1 positions");
  EXPECT_EQ(joints.add(1, Names{"pan", "lift"}, Numbers{NAN, 0.5}),
            "joint 'pan' is nan, must be finite");
  EXPECT_EQ(joints.add(1, Names{"lift"}, Numbers{0.5}),
            "joint 'lift': it is not later than the sample before");
  EXPECT_EQ(joints.counts().refused, 5);
  EXPECT_EQ(joints.counts().accepted, 1);  // lift, beside pan's NaN
  EXPECT_EQ(joints.unseen(), (Names{"pan", "wheel"}));
  EXPECT_EQ(joints.at(1, Names{"pan"}, kGap, kBeyond).reason, "joint 'pan': no position received");
}

TEST(JointBuffer, GapIsMissing) {
  JointBuffer joints = buffer();
  joints.add(us(0), Names{"pan"}, Numbers{0});
  joints.add(us(0.5), Names{"pan"}, Numbers{0.1});
  EXPECT_EQ(joints.at(us(0.25), Names{"pan"}, kGap, kBeyond).reason,
            "joint 'pan': gap of 0.500 s between samples (limit 0.2 s)");
}

TEST(JointBuffer, JumpIsFlagged) {
  JointBuffer joints = buffer();
  const Names pan{"pan"};
  joints.add(us(0), pan, Numbers{0});
  joints.add(us(0.01), pan, Numbers{0.01});
  EXPECT_EQ(joints.add(us(0.02), pan, Numbers{1.01}),
            "joint 'pan' jumps by 1.000 in 0.010 s (max_joint_speed is 20 per s)");
  joints.add(us(0.03), pan, Numbers{1.02});
  EXPECT_EQ(joints.flaw(us(0), us(0.01), pan), "");
  EXPECT_NE(joints.flaw(us(0.01), us(0.02), pan), "");
  EXPECT_EQ(joints.flaw(us(0.02), us(0.03), pan), "");
  EXPECT_EQ(joints.counts().jumps, 1);
}

TEST(JointBuffer, WheelsMaySpin) {
  JointBuffer joints = buffer();
  const Names wheel{"wheel"};
  joints.allowAnySpeed(wheel);
  for (int i = 0; i <= 10; ++i)
    EXPECT_EQ(
        joints.add(us(0.01 * i), wheel, Numbers{std::remainder(0.5 * i, 2 * std::numbers::pi)}),
        "");
  EXPECT_EQ(joints.counts().jumps, 0);
  EXPECT_NEAR(joints.at(us(0.095), wheel, kGap, kBeyond).q.at("wheel"), 4.75, 1e-9);
}

TEST(JointBuffer, OffsetShiftsAndClockThatGoesBackBeginsAnew) {
  JointBuffer joints = buffer(0.02);
  const Names pan{"pan"};
  for (int i = 0; i <= 10; ++i) joints.add(us(50 + 0.1 * i), pan, Numbers{0.1 * i});
  EXPECT_NEAR(joints.at(us(50.52), pan, kGap, kBeyond).q.at("pan"), 0.5, 1e-12);
  for (int i = 0; i < Timeline::kRestartSamples; ++i) joints.add(us(0.1 * i), pan, Numbers{1});
  EXPECT_EQ(joints.counts().restarts, 1);
  EXPECT_EQ(joints.add(us(0.6), pan, Numbers{1}), "");
}

}  // namespace
}  // namespace rf
