// SPDX-License-Identifier: BSD-3-Clause
// Poses against chains multiplied by hand, and the Jacobian against differences.
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <locale>
#include <numbers>

#include "kinematics/robot_model.hpp"
#include "urdf_text.hpp"

namespace rf {
namespace {

constexpr double kExact = 1e-12;  // products of a few doubles

SE3 shift(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), Vec3(x, y, z)}; }
SE3 turn(const Vec3& axis, double angle) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized())), Vec3::Zero()};
}

RobotModel manipulator() { return RobotModel::fromUrdf(urdfManipulator(), "robot.urdf"); }

void expectSame(const SE3& a, const SE3& b, double tolerance = kExact) {
  EXPECT_LT((a.inverse() * b).log().norm(), tolerance)
      << "translations " << a.t.transpose() << " and " << b.t.transpose();
}

TEST(Chain, HeadIsMountPanTiltOptical) {
  const double pan = 0.7;
  const double tilt = -0.4;
  const double half = std::numbers::pi / 2;
  const SE3 by_hand = shift(0.1, 0, 1.2) * turn(Vec3::UnitZ(), 0.3) * shift(0, 0, 0.05) *
                      turn(Vec3::UnitZ(), pan) * shift(0.02, 0, 0.1) * turn(Vec3::UnitY(), tilt) *
                      shift(0.05, 0, 0) * turn(Vec3::UnitZ(), -half) * turn(Vec3::UnitX(), -half);
  expectSame(manipulator().T_AB("base", "camera", {{"pan", pan}, {"tilt", tilt}}), by_hand);
}

TEST(Chain, OpticalFrameLooksForward) {
  const SE3 T_BC = manipulator().T_AB("tilt_link", "camera", {});
  EXPECT_LT((T_BC.R() * Vec3::UnitZ() - Vec3::UnitX()).norm(), kExact);  // z forward
  EXPECT_LT((T_BC.R() * Vec3::UnitX() + Vec3::UnitY()).norm(), kExact);  // x right
}

TEST(Chain, ArmSlidesAndTurns) {
  const SE3 by_hand = shift(0.2, 0.1, 0.5) * turn(Vec3::UnitX(), 0.1) * shift(0, 0, 0.25) *
                      shift(0.3, 0, 0) * turn(Vec3(0, 0.6, 0.8), 4.5);
  expectSame(manipulator().T_AB("base", "gripper", {{"lift", 0.25}, {"elbow", 4.5}}), by_hand);
}

TEST(Chain, MimicFollowsItsMaster) {
  const RobotModel robot = manipulator();
  expectSame(robot.T_AB("gripper", "left", {{"left_finger", 0.02}}), shift(0, 0.06, 0));
  expectSame(robot.T_AB("gripper", "right", {{"left_finger", 0.02}}),
             shift(0, -0.04 - 2 * 0.02 + 0.01, 0));
  EXPECT_EQ(robot.jointsBetween("gripper", "right"), std::vector<std::string>{"left_finger"});
  // Its own encoder, where the robot reports one, is not asked.
  expectSame(robot.T_AB("gripper", "right", {{"left_finger", 0.02}, {"right_finger", 9}}),
             shift(0, -0.07, 0));
}

TEST(Chain, MimicOfMimicIsResolved) {
  const std::string xml =
      urdfRobot(urdfLink("a") + urdfLink("b") + urdfLink("c") + urdfLink("d") +
                urdfJoint("j1", "continuous", "a", "b", "xyz='0 0 0'", "<axis xyz='0 0 1'/>") +
                urdfJoint("j2", "continuous", "b", "c", "xyz='1 0 0'",
                          "<axis xyz='0 0 1'/><mimic joint='j1' multiplier='2' offset='0.1'/>") +
                urdfJoint("j3", "continuous", "c", "d", "xyz='1 0 0'",
                          "<axis xyz='0 0 1'/><mimic joint='j2' multiplier='-1' offset='0.2'/>"));
  const RobotModel robot = RobotModel::fromUrdf(xml, "x");
  const double q = 0.3;
  const double q2 = 2 * q + 0.1;
  expectSame(robot.T_AB("a", "d", {{"j1", q}}), turn(Vec3::UnitZ(), q) * shift(1, 0, 0) *
                                                    turn(Vec3::UnitZ(), q2) * shift(1, 0, 0) *
                                                    turn(Vec3::UnitZ(), 0.2 - q2));
  EXPECT_EQ(robot.movableJoints(), std::vector<std::string>{"j1"});
}

TEST(Chain, BranchesAndDirectionsCancel) {
  const RobotModel robot = manipulator();
  const JointPositions q{
      {"pan", 0.7}, {"tilt", -0.4}, {"lift", 0.25}, {"elbow", 1.5}, {"left_finger", 0.01}};
  const auto links = robot.links();
  for (const std::string& a : links) {
    expectSame(robot.T_AB(a, a, {}), SE3());
    for (const std::string& b : links) {
      expectSame(robot.T_AB(a, b, q),
                 robot.T_AB("base", a, q).inverse() * robot.T_AB("base", b, q));
    }
  }
}

TEST(Chain, AsksOnlyForJointsOnTheWay) {
  const RobotModel robot = manipulator();
  using Names = std::vector<std::string>;
  EXPECT_EQ(robot.jointsBetween("base", "camera"), (Names{"pan", "tilt"}));
  EXPECT_EQ(robot.jointsBetween("camera", "gripper"), (Names{"elbow", "lift", "pan", "tilt"}));
  EXPECT_EQ(robot.jointsBetween("base", "mount"), Names{});
  EXPECT_EQ(robot.movableJoints(), (Names{"lift", "elbow", "left_finger", "pan", "tilt"}));
  EXPECT_EQ(robot.jointKind("pan"), JointKind::kRevolute);
  EXPECT_EQ(robot.jointKind("elbow"), JointKind::kContinuous);
  EXPECT_EQ(robot.jointKind("lift"), JointKind::kPrismatic);
  EXPECT_THROW(robot.jointKind("right_finger"), KinematicsError);
  EXPECT_NO_THROW(robot.T_AB("base", "gripper", {{"lift", 0}, {"elbow", 0}}));
}

TEST(Chain, JacobianAgreesWithDifferences) {
  const RobotModel robot = manipulator();
  const JointPositions q{
      {"pan", 0.7}, {"tilt", -0.4}, {"lift", 0.25}, {"elbow", 1.5}, {"left_finger", 0.01}};
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-8;  // central differences: step^2 plus rounding / step
  for (const std::string& a : robot.links()) {
    for (const std::string& b : robot.links()) {
      const RobotJacobian jacobian = robot.jacobian(a, b, q);
      ASSERT_EQ(jacobian.joints, robot.jointsBetween(a, b));
      for (std::size_t i = 0; i < jacobian.joints.size(); ++i) {
        JointPositions up = q;
        JointPositions down = q;
        up[jacobian.joints[i]] += kStep;
        down[jacobian.joints[i]] -= kStep;
        const Vec6 numeric =
            (robot.T_AB(a, b, down).inverse() * robot.T_AB(a, b, up)).log() / (2 * kStep);
        EXPECT_LT((jacobian.J.col(static_cast<Eigen::Index>(i)) - numeric).norm(), kTolerance)
            << a << " to " << b << " by " << jacobian.joints[i];
      }
    }
  }
}

std::string problem(const std::string& a, const std::string& b, const JointPositions& q) {
  try {
    manipulator().T_AB(a, b, q);
  } catch (const KinematicsError& e) {
    return e.what();
  }
  return "";
}

TEST(Chain, ErrorsNameSourceElementAndRule) {
  EXPECT_EQ(problem("base", "hand", {}), "robot.urdf: link 'hand': there is no such link");
  EXPECT_EQ(problem("base", "camera", {{"pan", 0}}),
            "robot.urdf: joint 'tilt': no position is given");
  EXPECT_EQ(problem("base", "camera", {{"pan", 0}, {"tilt", NAN}}),
            "robot.urdf: joint 'tilt': position is nan, must be finite");
  EXPECT_EQ(problem("gripper", "right", {}),
            "robot.urdf: joint 'left_finger' (which joint 'right_finger' mimics): no position is "
            "given");
}

struct CommaPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(Chain, NumbersDoNotDependOnTheLocale) {
  const SE3 expected = manipulator().T_AB("base", "mount", {});
  const std::locale before = std::locale::global(std::locale(std::locale(), new CommaPoint));
  const std::string c_before = std::setlocale(LC_NUMERIC, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  }
  const SE3 found = manipulator().T_AB("base", "mount", {});
  std::setlocale(LC_NUMERIC, c_before.c_str());
  std::locale::global(before);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(found.t.z(), 1.2);
}

}  // namespace
}  // namespace rf
