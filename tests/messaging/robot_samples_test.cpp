// SPDX-License-Identifier: BSD-3-Clause
// Foreign and own messages of a robot as values, and what is said of malformed ones.
#include "messaging/robot_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "random_values.hpp"

namespace rf {
namespace {

bot_core::robot_state_t robotState() {
  bot_core::robot_state_t m;
  m.utime = 7;
  m.pose.translation = {};
  m.pose.translation.x = 1;
  m.pose.translation.y = 2;
  m.pose.translation.z = 3;
  m.pose.rotation.w = 1;
  m.pose.rotation.x = m.pose.rotation.y = m.pose.rotation.z = 0;
  m.twist.linear_velocity.x = 3;
  m.twist.linear_velocity.y = 4;
  m.twist.linear_velocity.z = 0;
  m.twist.angular_velocity.x = m.twist.angular_velocity.y = 0;
  m.twist.angular_velocity.z = -2;
  m.num_joints = 2;
  m.joint_name = {"pan", "tilt"};
  m.joint_position = {0.5F, 0.25F};
  m.joint_velocity = {0, 0};
  m.joint_effort = {0, 0};
  m.force_torque = {};
  return m;
}

TEST(RobotSamples, PoseCarriesItsVelocity) {
  RandomValues random(1);
  const SE3 T = random.transform();
  bot_core::pose_t m{};
  m.utime = 5;
  for (int i = 0; i < 3; ++i) m.pos[i] = T.t[i];
  m.orientation[0] = T.q.w();
  for (int i = 0; i < 3; ++i) m.orientation[i + 1] = T.q.vec()[i];
  m.vel[0] = 0.3;
  m.vel[1] = 0.4;
  m.rotation_rate[2] = -0.7;
  const auto sample = robotSample("pose_t", encodeMessage(m));
  ASSERT_TRUE(sample) << sample.error;
  EXPECT_EQ(sample->utime, 5);
  EXPECT_EQ(sample->pose->T_WB, T);
  EXPECT_DOUBLE_EQ(sample->pose->stated->speed, 0.5);
  EXPECT_DOUBLE_EQ(sample->pose->stated->turn, 0.7);
  m.vel[0] = NAN;  // a sender that does not know it
  EXPECT_FALSE(robotSample("pose_t", encodeMessage(m))->pose->stated.has_value());
}

TEST(RobotSamples, RigidTransform) {
  bot_core::rigid_transform_t m{};
  m.utime = 6;
  m.trans[1] = 2;
  m.quat[0] = 1;
  const auto sample = robotSample("rigid_transform_t", encodeMessage(m));
  ASSERT_TRUE(sample) << sample.error;
  EXPECT_EQ(sample->pose->T_WB.t, Vec3(0, 2, 0));
  EXPECT_FALSE(sample->pose->stated.has_value());
}

TEST(RobotSamples, RobotStateHasPoseAndJoints) {
  const auto sample = robotSample("robot_state_t", encodeMessage(robotState()));
  ASSERT_TRUE(sample) << sample.error;
  EXPECT_EQ(sample->pose->T_WB.t, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(sample->pose->stated->speed, 5);
  EXPECT_DOUBLE_EQ(sample->pose->stated->turn, 2);
  EXPECT_EQ(sample->joints->names, (std::vector<std::string>{"pan", "tilt"}));
  EXPECT_EQ(sample->joints->positions, (std::vector<double>{0.5, 0.25}));
}

TEST(RobotSamples, UpdateIsUsedOnlyWhenValid) {
  pronto::update_t m{};
  m.timestamp = 20;
  m.prev_timestamp = 10;
  m.translation[0] = 0.1;
  m.rotation[0] = 1;
  m.estimate_status = pronto::update_t::ESTIMATE_VALID;
  const auto sample = robotSample("update_t", encodeMessage(m));
  ASSERT_TRUE(sample) << sample.error;
  EXPECT_EQ(sample->utime, 20);
  EXPECT_EQ(sample->increment->from_utime, 10);
  EXPECT_EQ(sample->increment->T_prev_now.t, Vec3(0.1, 0, 0));
  m.estimate_status = pronto::update_t::ESTIMATE_DEGENERATE;
  EXPECT_EQ(robotSample("update_t", encodeMessage(m)).error,
            "update_t: estimate_status is 3, only 1 (valid) is used");
}

TEST(RobotSamples, OwnTypesSurviveTheTrip) {
  RandomValues random(2);
  const auto twist = robotSample("planar_twist_t", packTwist(9, {0.1, -0.2, 0.3}));
  ASSERT_TRUE(twist) << twist.error;
  EXPECT_EQ(twist->utime, 9);
  EXPECT_EQ(twist->twist->vy, -0.2);
  const Grasp grasp{11, true, random.transform()};
  const auto back = robotSample("grasp_t", packGrasp(grasp));
  ASSERT_TRUE(back) << back.error;
  EXPECT_EQ(back->grasp->utime, 11);
  EXPECT_TRUE(back->grasp->held);
  EXPECT_EQ(back->grasp->T_GO, grasp.T_GO);
  EXPECT_FALSE(robotSample("grasp_t", packGrasp({12, false, SE3()}))->grasp->held);
  const auto joints = robotSample("joint_state_t", packJoints(3, {{"a", "b"}, {0.5, NAN}}));
  ASSERT_TRUE(joints) << joints.error;
  EXPECT_EQ(joints->joints->names, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(std::isnan(joints->joints->positions[1]));  // the joint buffer says so
  EXPECT_THROW(packJoints(3, {{"a"}, {}}), std::invalid_argument);
}

TEST(RobotSamples, GraspMustBeYesOrNo) {
  rigidfusion::grasp_t m{};
  m.held = 2;
  EXPECT_EQ(robotSample("grasp_t", encodeMessage(m)).error, "grasp_t: held is 2, must be 0 or 1");
}

TEST(RobotSamples, TypesMustBeKnown) {
  EXPECT_NO_THROW(checkOdometryType("update_t", "x"));
  EXPECT_NO_THROW(checkJointsType("robot_state_t", "x"));
  try {
    checkJointsType("pose_t", "prior.robot.channels.joints_type");
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_STREQ(e.what(),
                 "prior.robot.channels.joints_type = pose_t: must be one of joint_state_t, "
                 "robot_state_t");
  }
}

/// Every type cut short, lengthened, with counts blown up and bytes changed: a reason, no crash.
TEST(RobotSamples, MalformedBytesAreRefusedWithAReason) {
  RandomValues random(3);
  pronto::update_t update{};
  update.estimate_status = 1;
  update.rotation[0] = 1;
  const std::vector<std::pair<std::string, Bytes>> samples = {
      {"pose_t", encodeMessage(bot_core::pose_t{})},
      {"rigid_transform_t", encodeMessage(bot_core::rigid_transform_t{})},
      {"joint_state_t", packJoints(3, {{"pan", "tilt", ""}, {1, 2, 3}})},
      {"robot_state_t", encodeMessage(robotState())},
      {"update_t", encodeMessage(update)},
      {"planar_twist_t", packTwist(1, {})},
      {"grasp_t", packGrasp({1, true, SE3()})}};
  for (const auto& [type, good] : samples) {
    ASSERT_TRUE(robotSample(type, good)) << type;
    for (std::size_t n = 0; n < good.size(); ++n) {
      const auto result = robotSample(type, ByteView(good).first(n));
      EXPECT_FALSE(result) << type << " cut to " << n;
      EXPECT_FALSE(result.error.empty());
    }
    Bytes longer = good;
    longer.push_back(0);
    EXPECT_FALSE(robotSample(type, longer)) << type;
    for (std::size_t at = 8; at + 2 <= good.size(); ++at) {
      for (const std::uint8_t high : {std::uint8_t{0x7F}, std::uint8_t{0xFF}}) {
        Bytes bad = good;
        bad[at] = high;
        bad[at + 1] = 0xFF;
        const auto result = robotSample(type, bad);
        EXPECT_EQ(static_cast<bool>(result), result.error.empty());
      }
    }
    for (int i = 0; i < 1000; ++i) {
      Bytes bad = good;
      for (int k = 0; k < 4; ++k) {
        bad[static_cast<std::size_t>(
            random.integer(0, static_cast<std::int64_t>(bad.size()) - 1))] =
            static_cast<std::uint8_t>(random.integer(0, 255));
      }
      const auto result = robotSample(type, bad);
      EXPECT_EQ(static_cast<bool>(result), result.error.empty());
    }
    for (const auto& [other, bytes] : samples) {
      if (other == type) continue;
      EXPECT_NE(robotSample(type, bytes).error.find("hash"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace rf
