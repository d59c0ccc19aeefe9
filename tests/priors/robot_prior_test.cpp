// SPDX-License-Identifier: BSD-3-Clause
#include "priors/robot_prior.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../kinematics/urdf_text.hpp"
#include "pipeline/prior_stage.hpp"

namespace rf {
namespace {

using Names = std::vector<std::string>;
using Numbers = std::vector<double>;
const Names kJoints{"pan", "tilt", "lift", "elbow"};

PriorConfig config() {
  PriorConfig c;
  c.robot.base_link = "base";
  c.robot.camera_link = "camera";
  c.robot.gripper_link = "gripper";
  return c;
}

RobotModel model() { return RobotModel::fromUrdf(urdfManipulator(), "robot.urdf"); }

std::int64_t us(double seconds) { return std::llround(seconds * 1e6); }

/// What the robot truly does.
SE3 baseAt(double t) { return arc({0.3, 0, 0.5}, t); }
Numbers jointsAt(double t) { return {0.4 * t, -0.2 * t, 0.05 * t, 0.6 * t}; }
JointPositions positionsAt(double t) {
  const Numbers q = jointsAt(t);
  return {{"pan", q[0]}, {"tilt", q[1]}, {"lift", q[2]}, {"elbow", q[3]}};
}
SE3 graspPose() { return {Eigen::Quaterniond::Identity(), Vec3(0.1, 0, 0.05)}; }

void feed(RobotPrior& robot, double from, double to) {
  for (int i = 0; from + 0.01 * i < to + 1e-9; ++i) {
    const double t = from + 0.01 * i;
    robot.odometry().addPose(us(t), baseAt(t));
    robot.joints().add(us(t), kJoints, jointsAt(t));
  }
}

RobotPrior fed(const PriorConfig& c = config()) {
  RobotPrior robot(model(), c);
  feed(robot, 0, 2);
  return robot;
}

MotionPrior pair(double a, double b) {
  MotionPrior prior;
  prior.utime_a = us(a);
  prior.utime_b = us(b);
  return prior;
}

void expectSame(const SE3& a, const SE3& b, double tolerance = 1e-9) {
  EXPECT_LT((a.inverse() * b).log().norm(), tolerance)
      << a.t.transpose() << " and " << b.t.transpose();
}

TEST(RobotPrior, CameraOnPanTiltHead) {
  const RobotPrior robot = fed();
  MotionPrior prior = pair(0.505, 0.538);
  EXPECT_EQ(robot.fillCamera(prior), "");
  EXPECT_EQ(prior.camera, PriorState::kValid);
  const auto truth = [&](double t) {
    return baseAt(t) * robot.model().T_AB("base", "camera", positionsAt(t));
  };
  expectSame(prior.T_WCb, truth(0.538));
  expectSame(prior.T_CaCb, truth(0.505).inverse() * truth(0.538));
  expectSame(robot.cameraPose(us(0.7)).value(), truth(0.7));
}

TEST(RobotPrior, CameraInTheHandOfAFixedArm) {
  PriorConfig c = config();
  c.robot.camera_link = "gripper";
  c.robot.gripper_link = "";
  c.robot.fixed_base = true;
  RobotPrior robot(model(), c);
  EXPECT_FALSE(robot.hasGripper());
  for (int i = 0; i <= 100; ++i) robot.joints().add(us(0.01 * i), kJoints, jointsAt(0.01 * i));
  MotionPrior prior = pair(0.3, 0.333);
  EXPECT_EQ(robot.fillCamera(prior), "");
  expectSame(prior.T_WCb, robot.model().T_AB("base", "gripper", positionsAt(0.333)));
  EXPECT_EQ(robot.fillObject(prior), "");
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kNone);
}

TEST(RobotPrior, CameraFixedToTheBaseNeedsNoJoints) {
  PriorConfig c = config();
  c.robot.camera_link = "mount";
  c.robot.gripper_link = "";
  RobotPrior robot(model(), c);
  for (int i = 0; i <= 100; ++i) robot.odometry().addPose(us(0.01 * i), baseAt(0.01 * i));
  MotionPrior prior = pair(0.3, 0.333);
  EXPECT_EQ(robot.fillCamera(prior), "");
  const SE3 T_BC = robot.model().T_AB("base", "mount", {});
  expectSame(prior.T_WCb, baseAt(0.333) * T_BC);
  EXPECT_TRUE(robot.covers(us(1)));
}

TEST(RobotPrior, FirstFrameHasNoMotion) {
  const RobotPrior robot = fed();
  MotionPrior prior = pair(0.5, 0.5);
  EXPECT_EQ(robot.fillCamera(prior), "");
  EXPECT_EQ(prior.T_CaCb, SE3());
}

/// Covariance of f(noise), by differences: noise has unit-free components with these variances;
/// f gives a transform whose right perturbation counts.
Mat6 numericCovariance(const std::function<SE3(const Eigen::VectorXd&)>& f,
                       const Eigen::VectorXd& variance) {
  constexpr double kStep = 1e-5;
  const SE3 centre = f(Eigen::VectorXd::Zero(variance.size()));
  Mat6 out = Mat6::Zero();
  for (Eigen::Index i = 0; i < variance.size(); ++i) {
    Eigen::VectorXd up = Eigen::VectorXd::Zero(variance.size());
    up[i] = kStep;
    const Vec6 column =
        ((centre.inverse() * f(up)).log() - (centre.inverse() * f(-up)).log()) / (2 * kStep);
    out += variance[i] * column * column.transpose();
  }
  return out;
}

TEST(RobotPrior, CameraCovarianceIsThatOfBaseAndJoints) {
  PriorConfig c = config();
  c.robot.encoder_sigma = 0.003;
  const RobotPrior robot = fed(c);
  MotionPrior prior = pair(0.5, 0.7);
  ASSERT_EQ(robot.fillCamera(prior), "");
  const SE3 d = baseAt(0.5).inverse() * baseAt(0.7);
  const Mat6 base = incrementCovariance(c.robot.base_drift, d, 0.2);
  Eigen::VectorXd variance(10);  // 6 of the base, pan and tilt at both ends
  variance << base.diagonal(), Eigen::Vector4d::Constant(9e-6);
  const auto noisy = [&](const Eigen::VectorXd& n) {
    JointPositions a = positionsAt(0.5);
    JointPositions b = positionsAt(0.7);
    a["pan"] += n[6];
    a["tilt"] += n[7];
    b["pan"] += n[8];
    b["tilt"] += n[9];
    const Vec6 e = n.head<6>();
    return robot.model().T_AB("base", "camera", a).inverse() * d * SE3::exp(e) *
           robot.model().T_AB("base", "camera", b);
  };
  const Mat6 numeric = numericCovariance(noisy, variance);
  EXPECT_LT((prior.camera_cov - numeric).norm(), 1e-6 * numeric.norm());
}

TEST(RobotPrior, HeldObjectFollowsTheGripper) {
  PriorConfig c = config();
  c.robot.slide_sigma = 0.002;
  RobotPrior robot = fed(c);
  robot.grasps().add({us(0.4), true, graspPose()});
  MotionPrior prior = pair(0.5, 0.6);
  EXPECT_EQ(robot.fillObject(prior), "");
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kCameraFrame);
  EXPECT_EQ(prior.object, PriorState::kValid);
  const auto truth = [&](const JointPositions& q) {
    return robot.model().T_AB("camera", "gripper", q) * graspPose();
  };
  expectSame(prior.T_XOa, truth(positionsAt(0.5)));
  expectSame(prior.T_XOb, truth(positionsAt(0.6)));

  const Mat6 slip =
      incrementCovariance(c.robot.grasp_drift, prior.T_XOa.inverse() * prior.T_XOb, 0.1);
  const Names moved{"pan", "tilt", "lift", "elbow"};
  Eigen::VectorXd variance(14);
  variance.head<6>() = slip.diagonal();
  for (int i = 0; i < 8; ++i)
    variance[6 + i] = moved[static_cast<std::size_t>(i % 4)] == "lift" ? 4e-6 : 1e-6;
  const auto noisy = [&](const Eigen::VectorXd& n) {
    JointPositions a = positionsAt(0.5);
    JointPositions b = positionsAt(0.6);
    for (int i = 0; i < 4; ++i) {
      a[moved[static_cast<std::size_t>(i)]] += n[6 + i];
      b[moved[static_cast<std::size_t>(i)]] += n[10 + i];
    }
    const Vec6 s = n.head<6>();
    return truth(a) * (truth(b) * SE3::exp(s)).inverse();
  };
  const Mat6 numeric = numericCovariance(noisy, variance);
  EXPECT_LT((prior.object_cov - numeric).norm(), 1e-6 * numeric.norm());
}

TEST(RobotPrior, ReleasedObjectHasNoPrior) {
  RobotPrior robot = fed();
  const auto state = [&](double a, double b) {
    MotionPrior prior = pair(a, b);
    EXPECT_EQ(robot.fillObject(prior), "");  // nothing is wrong
    return prior.object;
  };
  EXPECT_EQ(state(0.1, 0.2), PriorState::kMissing);
  robot.grasps().add({us(0.4), true, graspPose()});
  robot.grasps().add({us(0.8), false, SE3()});
  EXPECT_EQ(state(0.35, 0.45), PriorState::kMissing);
  EXPECT_EQ(state(0.45, 0.55), PriorState::kValid);
  EXPECT_EQ(state(0.75, 0.85), PriorState::kMissing);
}

TEST(RobotPrior, OwnShapesStandInTheCameraFrame) {
  const RobotPrior robot = fed();
  MotionPrior prior = pair(0.5, 0.6);
  robot.fillSelf(prior);
  ASSERT_EQ(prior.self.size(), 3U);
  const auto& shapes = robot.model().collisionShapes();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    EXPECT_EQ(prior.self[i].kind, shapes[i].kind);
    EXPECT_EQ(prior.self[i].half, shapes[i].half);
    expectSame(prior.self[i].T_CS,
               robot.model().T_AB("camera", shapes[i].link, positionsAt(0.6)) * shapes[i].T_LS);
  }
  MotionPrior late = pair(5, 6);
  robot.fillSelf(late);
  EXPECT_TRUE(late.self.empty());  // where the joints are is not known
}

TEST(RobotPrior, ShapesBehindUnknownJointsAreLeftOut) {
  RobotPrior robot(model(), config());
  for (int i = 0; i <= 100; ++i)
    robot.joints().add(us(0.01 * i), Names{"pan", "tilt"}, Numbers{0.1, 0.2});
  MotionPrior prior = pair(0.5, 0.6);
  robot.fillSelf(prior);
  ASSERT_EQ(prior.self.size(), 1U);  // the base's
  EXPECT_EQ(prior.self[0].kind, RobotShapeKind::kCylinder);
}

TEST(RobotPrior, MissingAndLateIsSaid) {
  RobotPrior robot(model(), config());
  MotionPrior prior = pair(0.5, 0.6);
  EXPECT_EQ(robot.fillCamera(prior), "odometry: no pose received");
  EXPECT_EQ(prior.camera, PriorState::kMissing);
  for (int i = 0; i <= 200; ++i) robot.odometry().addPose(us(0.01 * i), baseAt(0.01 * i));
  EXPECT_EQ(robot.fillCamera(prior), "joint 'pan': no position received");
  for (int i = 0; i <= 55; ++i)
    robot.joints().add(us(0.01 * i), Names{"pan", "tilt"}, Numbers{0.1, 0.2});
  EXPECT_EQ(robot.fillCamera(prior), "joint 'tilt': 0.050 s after the newest sample");
  EXPECT_EQ(prior.camera, PriorState::kExtrapolated);
  EXPECT_FALSE(robot.covers(us(0.6)));
  prior = pair(0.6, 0.7);
  EXPECT_EQ(robot.fillCamera(prior), "joint 'pan': 0.150 s after the newest sample (limit 0.1 s)");
  const auto complaints = robot.complaints();
  EXPECT_EQ(complaints, (Names{"joint 'elbow' has no samples: object priors are missing",
                               "joint 'lift' has no samples: object priors are missing"}));
}

TEST(RobotPrior, JumpsAndFrozenWheelsAreMissing) {
  const std::string xml = urdfRobot(
      urdfLink("base") + urdfLink("camera") + urdfLink("w") +
      urdfJoint("mount", "fixed", "base", "camera", "xyz='0 0 1'") +
      urdfJoint("wheel", "continuous", "base", "w", "xyz='0 0.3 0'", "<axis xyz='0 1 0'/>"));
  PriorConfig c = config();
  c.robot.gripper_link = "";
  c.robot.wheel_joints = " wheel ";
  RobotPrior robot(RobotModel::fromUrdf(xml, "robot.urdf"), c);
  double angle = 0;
  for (int i = 0; i <= 300; ++i) {
    const double t = 0.01 * i;
    const double x = t < 1 ? 0.3 * t : t < 2 ? 0.3 : 5 + 0.3 * (t - 2);  // frozen, then a jump
    robot.odometry().addPose(us(t), {Eigen::Quaterniond::Identity(), Vec3(x, 0, 0)});
    robot.joints().add(us(t), Names{"wheel"}, Numbers{std::remainder(angle, 2 * M_PI)});
    angle += 0.03;
  }
  MotionPrior moving = pair(0.5, 0.53);
  EXPECT_EQ(robot.fillCamera(moving), "");
  MotionPrior frozen = pair(1.5, 1.53);
  EXPECT_EQ(robot.fillCamera(frozen),
            "odometry stands still for 0.530 s although wheel 'wheel' turns at 3.000 rad/s");
  EXPECT_EQ(frozen.camera, PriorState::kMissing);
  MotionPrior jump = pair(1.985, 2.015);
  EXPECT_EQ(robot.fillCamera(jump), "odometry jumps by 4.700 m in 0.010 s (max_speed is 3 m/s)");
  EXPECT_EQ(jump.camera, PriorState::kMissing);
  MotionPrior after = pair(2.5, 2.53);
  EXPECT_EQ(robot.fillCamera(after), "");
}

std::string refusal(const PriorConfig& c) {
  try {
    RobotPrior robot(model(), c);
  } catch (const KinematicsError& e) {
    return e.what();
  }
  return "";
}

TEST(RobotPrior, ConfigurationMustFitTheRobot) {
  PriorConfig c = config();
  c.robot.camera_link = "cam";
  EXPECT_EQ(refusal(c), "robot.urdf: link 'cam': there is no such link");
  c = config();
  c.robot.gripper_link = "hand";
  EXPECT_EQ(refusal(c), "robot.urdf: link 'hand': there is no such link");
  c = config();
  c.robot.wheel_joints = "left, right";
  EXPECT_EQ(refusal(c), "robot.urdf: joint 'left': there is no such movable joint");
}

TEST(PriorStageWithRobot, RobotGivesWhatNoOtherSourceGives) {
  PriorStage stage(config());
  RobotPrior robot = fed();
  robot.grasps().add({us(0.1), true, graspPose()});
  stage.useRobot(robot, true, true);
  stage.process(us(0.5), 0);
  const MotionPrior prior = stage.process(us(0.533), 1);
  EXPECT_EQ(prior.camera, PriorState::kValid);
  EXPECT_EQ(prior.object, PriorState::kValid);
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kCameraFrame);
  EXPECT_EQ(prior.self.size(), 3U);
  EXPECT_TRUE(stage.covers(us(2)));
  EXPECT_FALSE(stage.covers(us(2.1)));
  EXPECT_EQ(stage.process(us(4), 2).camera, PriorState::kMissing);
  EXPECT_EQ(stage.status().camera_missing, 1);
  EXPECT_NE(stage.status().camera_reason, "");
}

TEST(PriorStageWithRobot, ExplicitSourcesWin) {
  PriorStage stage(config());
  RobotPrior robot = fed();
  robot.grasps().add({us(0.1), true, graspPose()});
  stage.useRobot(robot, true, true);
  Trajectory still;
  for (int i = 0; i <= 200; ++i) still.push_back({us(0.01 * i), SE3()});
  stage.addCameraPoses(still);
  stage.addObjectPoses(still);
  stage.process(us(0.5), 0);
  const MotionPrior prior = stage.process(us(0.533), 1);
  EXPECT_EQ(prior.T_CaCb, SE3());
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kWorldFrame);
  EXPECT_EQ(prior.self.size(), 3U);

  PriorStage without(config());
  without.useRobot(robot, false, false);
  const MotionPrior none = without.process(us(0.5), 0);
  EXPECT_EQ(none.camera, PriorState::kMissing);
  EXPECT_EQ(none.object_kind, ObjectPriorKind::kNone);
  EXPECT_EQ(without.status().camera_missing, 0);
}

}  // namespace
}  // namespace rf
