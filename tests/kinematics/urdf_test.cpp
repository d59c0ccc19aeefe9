// SPDX-License-Identifier: BSD-3-Clause
// What a URDF may be, and what is said of one that must not be.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "kinematics/robot_model.hpp"
#include "urdf_text.hpp"

/// urdfdom lets go of a model whose links own each other in a circle when it finds no root; nobody
/// can reach it then. Looked at by the leak sanitizer only.
extern "C" const char* __lsan_default_suppressions();  // NOLINT: the sanitizer's name
const char* __lsan_default_suppressions() { return "leak:liburdfdom_model"; }  // NOLINT

namespace rf {
namespace {

std::string problem(const std::string& xml) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::string said;
  try {
    RobotModel::fromUrdf(xml, "robot.urdf");
  } catch (const KinematicsError& e) {
    said = e.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  return said;
}

void expectProblem(const std::string& xml, const std::string& part) {
  const std::string said = problem(xml);
  EXPECT_EQ(said.rfind("robot.urdf: ", 0), 0U) << said;
  EXPECT_NE(said.find(part), std::string::npos) << said << "\nshould hold: " << part;
}

/// Two links with one joint between.
std::string pair(const std::string& type, const std::string& origin, const std::string& rest) {
  return urdfRobot(urdfLink("a") + urdfLink("b") + urdfJoint("j", type, "a", "b", origin, rest));
}

TEST(Urdf, ManipulatorIsReadInSilence) {
  EXPECT_EQ(problem(urdfManipulator()), "");
  const RobotModel robot = RobotModel::fromUrdf(urdfManipulator(), "robot.urdf");
  EXPECT_EQ(robot.rootLink(), "base");
  EXPECT_TRUE(robot.hasLink("camera"));
  EXPECT_TRUE(robot.hasLink("base"));
  EXPECT_FALSE(robot.hasLink("hand"));
  EXPECT_EQ(robot.links(),
            (std::vector<std::string>{"base", "lift_link", "gripper", "left", "right", "mount",
                                      "pan_link", "tilt_link", "camera"}));
}

TEST(Urdf, CollisionShapes) {
  const RobotModel robot = RobotModel::fromUrdf(urdfManipulator(), "robot.urdf");
  const auto& shapes = robot.collisionShapes();
  ASSERT_EQ(shapes.size(), 3U);
  EXPECT_EQ(robot.skippedShapes(), 1U);  // the mesh
  EXPECT_EQ(shapes[0].link, "base");
  EXPECT_EQ(shapes[0].kind, RobotShapeKind::kCylinder);
  EXPECT_EQ(shapes[0].half, Vec3(0.3, 0.3, 0.1));
  EXPECT_EQ(shapes[0].T_LS.t, Vec3(0, 0, 0.1));
  EXPECT_EQ(shapes[1].link, "lift_link");
  EXPECT_EQ(shapes[1].kind, RobotShapeKind::kBox);
  EXPECT_EQ(shapes[1].half, Vec3(0.1, 0.2, 0.3));
  EXPECT_NEAR(
      shapes[1].T_LS.q.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3::UnitZ()))),
      0, 1e-7);
  EXPECT_EQ(shapes[2].kind, RobotShapeKind::kSphere);
  EXPECT_EQ(shapes[2].half, Vec3(0.07, 0.07, 0.07));
}

TEST(Urdf, MalformedTextIsNamed) {
  expectProblem("", "not a usable URDF");
  expectProblem("not xml", "not a usable URDF");
  expectProblem("<robot name='x'>", "not a usable URDF");
  expectProblem("<model/>", "robot");
  expectProblem(std::string("<robot\0 name='x'/>", 18), "byte 6 is zero: not a text");
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  expectProblem(deep, "elements nest 100000 deep, at most 64 are allowed");
  expectProblem(std::string((16U << 20U) + 1, ' '), "a URDF may have at most 16777216");
}

TEST(Urdf, EveryTruncationIsRefusedInSilence) {
  const std::string xml = urdfManipulator();
  for (std::size_t n = 0; n + 9 < xml.size(); n += 13)
    EXPECT_NE(problem(xml.substr(0, n)), "") << n;
}

TEST(Urdf, TreeMustBeATree) {
  expectProblem(urdfRobot(""), "not a usable URDF");
  expectProblem(urdfRobot(urdfLink("a") + urdfLink("b")), "not a usable URDF");  // two roots
  expectProblem(urdfRobot(urdfLink("a") + urdfJoint("j", "fixed", "a", "b", "xyz='0 0 0'")), "[b]");
  expectProblem(urdfRobot(urdfLink("a") + urdfJoint("j", "fixed", "c", "a", "xyz='0 0 0'")), "[c]");
  expectProblem(urdfRobot(urdfLink("a") + urdfLink("a")), "not unique");
  const std::string links = urdfLink("a") + urdfLink("b") + urdfLink("c");
  const auto fixed = [](const char* name, const char* parent, const char* child) {
    return urdfJoint(name, "fixed", parent, child, "xyz='0 0 0'");
  };
  expectProblem(
      urdfRobot(links + fixed("j", "a", "b") + fixed("k", "b", "c") + fixed("l", "c", "a")),
      "not a usable URDF");  // no root
  expectProblem(urdfRobot(links + fixed("j", "b", "c") + fixed("k", "c", "b")), "closes a loop");
  expectProblem(
      urdfRobot(links + fixed("j", "a", "b") + fixed("k", "a", "c") + fixed("l", "b", "c")),
      "link 'c': is the child of joint 'k' and of joint 'l', must have one parent");
  expectProblem(urdfRobot(links + fixed("j", "a", "b") + fixed("j", "a", "c")), "not unique");
}

TEST(Urdf, NumbersMustBeNumbers) {
  expectProblem(pair("continuous", "xyz='0 0 0'", "<axis xyz='0 0 0'/>"),
                "joint 'j': axis is 0 0 0, must not be zero");
  for (const char* bad : {"nan 0 0", "0 inf 0", "0 0 1e999", "0 0 x", "0 0", "0,1 0 0"}) {
    expectProblem(pair("continuous", std::string("xyz='") + bad + "'", "<axis xyz='0 0 1'/>"), "");
    expectProblem(pair("continuous", "xyz='0 0 0'", std::string("<axis xyz='") + bad + "'/>"), "");
    expectProblem(pair("fixed", std::string("rpy='") + bad + "'", ""), "");
  }
}

TEST(Urdf, JointsMustBeUsable) {
  expectProblem(pair("revolute", "xyz='0 0 0'", "<axis xyz='0 0 1'/>"), "j");  // no limits
  expectProblem(pair("hinge", "xyz='0 0 0'", ""), "hinge");
  const auto mimic = [](const std::string& master) {
    return pair("continuous", "xyz='0 0 0'", "<axis xyz='0 0 1'/><mimic joint='" + master + "'/>");
  };
  expectProblem(mimic("k"), "joint 'j': mimics 'k', which does not exist");
  expectProblem(mimic("j"), "joint 'j': mimics 'j', which leads back to itself");
  expectProblem(urdfRobot(urdfLink("a") + urdfLink("b") + urdfLink("c") +
                          urdfJoint("f", "fixed", "b", "c", "xyz='0 0 0'") +
                          urdfJoint("j", "continuous", "a", "b", "xyz='0 0 0'",
                                    "<axis xyz='0 0 1'/><mimic joint='f'/>")),
                "joint 'j': mimics 'f', which does not move");
}

TEST(Urdf, ShapesMustHaveASize) {
  const auto shape = [](const std::string& geometry) {
    return urdfRobot(urdfLink("a", "<collision><geometry>" + geometry + "</geometry></collision>"));
  };
  EXPECT_EQ(problem(shape("<sphere radius='0.1'/>")), "");
  expectProblem(shape("<sphere radius='0'/>"), "link 'a': a collision shape has half sizes 0 0 0");
  expectProblem(shape("<box size='1 -1 1'/>"),
                "link 'a': a collision shape has half sizes 0.5 -0.5");
  expectProblem(shape("<cylinder radius='nan' length='1'/>"), "");
}

TEST(Urdf, FloatingJointsAreAllowedButNotCrossed) {
  const std::string xml = urdfRobot(
      urdfLink("world") + urdfLink("pelvis") + urdfLink("camera") +
      urdfJoint("free", "floating", "world", "pelvis", "xyz='0 0 0'") +
      urdfJoint("neck", "continuous", "pelvis", "camera", "xyz='0 0 1'", "<axis xyz='0 0 1'/>"));
  EXPECT_EQ(problem(xml), "");
  const RobotModel robot = RobotModel::fromUrdf(xml, "robot.urdf");
  EXPECT_EQ(robot.T_AB("pelvis", "camera", {{"neck", 0}}).t, Vec3(0, 0, 1));
  EXPECT_THROW(robot.T_AB("world", "camera", {{"neck", 0}}), KinematicsError);
  EXPECT_THROW(robot.jointsBetween("world", "camera"), KinematicsError);
}

}  // namespace
}  // namespace rf
