// SPDX-License-Identifier: BSD-3-Clause
// The scenes of the mobile manipulator: reachable, within limits, what its wheels and encoders say.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "simulation/arm_motion.hpp"
#include "simulation/joint_encoders.hpp"
#include "simulation/manipulator.hpp"
#include "simulation/raycaster.hpp"
#include "simulation/robot_description.hpp"
#include "simulation/wheels.hpp"
#include "simulation/world.hpp"

namespace rf::sim {
namespace {

constexpr double kDegree = 3.14159265358979 / 180;

struct Shares {
  double least = 1, most = 0, robot = 0, nearest = 1e9, nearest_room = 1e9;
};

/// Shares of carton and robot among the pixels in the sensor's range, from rays at an eighth of the
/// resolution, every tenth frame from `begin` on.
Shares sharesOf(World world, double begin) {
  world.camera = world.camera.reduced(8);
  Shares out;
  int frames = 0;
  for (double t = begin; t < world.frames / kFrameRate; t += 1.0 / 3) {
    const SurfaceImage s = Raycaster(world, bodyPoses(world, t), world.camera_at(t)).castAll();
    double valid = 0, carton = 0, robot = 0;
    for (std::size_t i = 0; i < s.z.size(); ++i) {
      const std::size_t u = i % 80;  // the sensor's borders have no depth
      const std::size_t v = i / 80;
      if (s.primitive[i] < 0 || u < 1 || u > 76 || v < 1 || v > 58) continue;
      const int body = world.primitives[static_cast<std::size_t>(s.primitive[i])].body;
      const double z = static_cast<double>(s.z[i]);
      if (body == 1) out.nearest = std::min(out.nearest, z);
      if (body == 0) out.nearest_room = std::min(out.nearest_room, z);
      if (z < 0.4 || z > 5.0) continue;
      valid += 1;
      carton += body == 1 ? 1 : 0;
      robot += body > 1 ? 1 : 0;
    }
    out.least = std::min(out.least, carton / valid);
    out.most = std::max(out.most, carton / valid);
    out.robot += robot / valid;
    ++frames;
  }
  out.robot /= frames;
  return out;
}

class CarryScene : public testing::TestWithParam<const char*> {};

TEST_P(CarryScene, CartonCoversALargeMovingShareWhileTheBaseDrives) {
  const World world = buildWorld(GetParam(), 1);
  ASSERT_NE(world.robot, nullptr);
  const Manipulator& robot = *world.robot;
  const Shares s = sharesOf(world, robot.grasp_time);
  double way = 0, turn = 0, apart = 0;
  for (int k = 1; k < world.frames; ++k) {
    const double t = k / kFrameRate;
    const SE3 step = robot.base_at(t - 1 / kFrameRate).inverse() * robot.base_at(t);
    way += step.t.norm();
    turn += step.log().tail<3>().norm();
    const auto inCamera = [&](double at) {
      return Vec3((world.camera_at(at).inverse() * world.body_at[0](at)).t);
    };
    apart += (inCamera(t) - inCamera(t - 1 / kFrameRate)).norm();
  }
  std::printf(
      "%s: base %.2f m, %.0f deg; carton %.2f m in the camera; share %.2f to %.2f, robot %.3f; "
      "carton nearest %.2f m, room %.2f m\n",
      GetParam(), way, turn / kDegree, apart, s.least, s.most, s.robot, s.nearest, s.nearest_room);
  EXPECT_GT(way, 2.0);
  EXPECT_LT(way, 3.2);
  EXPECT_GT(apart, 0.5) << "moves in the view";
  EXPECT_GT(s.least, 0.2);
  EXPECT_LT(s.least, 0.45);
  EXPECT_GT(s.most, 0.55);
  EXPECT_LT(s.most, 0.8);
  EXPECT_GT(s.robot, 0.01);
  EXPECT_GT(s.nearest, 0.38);
  EXPECT_GT(s.nearest_room, 0.4);
}

TEST_P(CarryScene, RestsForTheFirstSecondAndKeepsItsGrasp) {
  const World world = buildWorld(GetParam(), 1);
  const Manipulator& robot = *world.robot;
  EXPECT_EQ(world.camera_at(0.0), world.camera_at(0.95));
  EXPECT_EQ(world.body_at[0](0.0), world.body_at[0](0.95));
  EXPECT_EQ(robot.base_at(0.0), robot.base_at(std::max(0.0, robot.grasp_time)));
  for (double t = std::max(0.0, robot.grasp_time); t < 15; t += 0.37) {
    const SE3 T_WG =
        robot.base_at(t) * robot.model.T_AB(kBaseLink, kGripperLink, robot.joints_at(t));
    const SE3 off = robot.T_GO.inverse() * T_WG.inverse() * world.body_at[0](t);
    EXPECT_LT(off.log().norm(), 1e-9);
  }
  const std::vector<std::string> movable = robot.model.movableJoints();
  const JointPositions q = robot.joints_at(3.0);
  EXPECT_EQ(q.size(), movable.size());
  for (const std::string& joint : movable) EXPECT_TRUE(q.contains(joint)) << joint;
}

TEST_P(CarryScene, JointsMoveSmoothlyWithinTheirLimits) {
  const World world = buildWorld(GetParam(), 1);
  const Manipulator& robot = *world.robot;
  // As in the robot's description.
  const std::map<std::string, std::pair<double, double>> kLimits = {
      {"head_pan", {-1.6, 1.6}}, {"head_tilt", {-0.6, 1.0}}, {"arm_1", {-3.0, 3.0}},
      {"arm_2", {-1.2, 2.6}},    {"arm_3", {-2.7, 2.7}},     {"arm_4", {-6.2, 6.2}},
      {"arm_5", {-2.2, 2.2}},    {"arm_6", {-6.2, 6.2}},     {"finger", {0.0, 0.085}}};
  double worst = -1;
  double fastest = 0;
  std::string who;
  for (int k = 0; k < 10 * world.frames; ++k) {
    const double t = 0.1 * k / kFrameRate;
    const JointPositions now = robot.joints_at(t);
    const JointPositions next = robot.joints_at(t + 0.1 / kFrameRate);
    for (const auto& [name, value] : now) {
      if (kLimits.contains(name)) {
        worst = std::max({worst, kLimits.at(name).first - value, value - kLimits.at(name).second});
      }
      const double speed = std::abs(next.at(name) - value) * 10 * kFrameRate;
      if (speed > fastest) {
        fastest = speed;
        who = name;
      }
    }
  }
  std::printf("%s: fastest joint %s, %.2f rad/s\n", GetParam(), who.c_str(), fastest);
  EXPECT_LT(fastest, 1.5);
  EXPECT_LT(worst, 0) << "beyond a limit";
}

TEST_P(CarryScene, WheelsDriftButFollow) {
  const World world = buildWorld(GetParam(), 1);
  const Manipulator& robot = *world.robot;
  WheelModel perfect;
  perfect.scale_sigma = perfect.slip_sigma = perfect.spins_per_s = 0;
  const auto ideal = wheelOdometry(robot, perfect, -0.5, 15.5, 100, 1);
  const SE3 ideal_error = robot.base_at(15.5).inverse() * ideal.back().T_WB;
  // Two wheels do not see the lateral slip of the base: 0.04 s * 0.26 m/s * 0.3 rad/s at most.
  EXPECT_LT(ideal_error.t.norm(), robot.omnidirectional ? 0.005 : 0.04);
  EXPECT_LT(ideal_error.log().tail<3>().norm(), 0.01) << "ticks only";
  std::set<double> ends;
  double worst = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto driven = wheelOdometry(robot, {}, -0.5, 15.5, 100, seed);
    const SE3 error = robot.base_at(15.5).inverse() * driven.back().T_WB;
    ends.insert(error.t.norm());
    worst = std::max(worst, error.t.norm());
    EXPECT_LT(error.t.norm(), 0.4);
    EXPECT_EQ(driven[40].T_WB, driven[0].T_WB) << "rests before the drive";
  }
  EXPECT_EQ(ends.size(), 5U);
  EXPECT_GT(worst, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Carry, CarryScene,
                         testing::Values("carry_omni", "carry_diff", "carry_head"),
                         [](const auto& param) { return std::string(param.param); });

/// Sums of turning over a motion in steps of a tenth of a second: to the left and to the right
/// about z, and about all axes.
struct Turning {
  double left = 0, right = 0, all = 0;
};

Turning turningOf(const std::function<SE3(double)>& pose, double seconds) {
  Turning out;
  for (double t = 0; t < seconds; t += 0.1) {
    const Vec3 w = (pose(t).inverse() * pose(t + 0.1)).log().tail<3>();
    (w.z() > 0 ? out.left : out.right) += std::abs(w.z());
    out.all += w.norm();
  }
  return out;
}

TEST(CalibrationScenes, DriveTurnsToBothSidesWithTheCartonOutOfView) {
  const World world = buildWorld("calibrate_drive", 1);
  const Manipulator& robot = *world.robot;
  const double seconds = world.frames / kFrameRate;
  EXPECT_GE(seconds, 60);
  const Turning turning = turningOf(robot.base_at, seconds);
  EXPECT_GT(turning.left, 300 * kDegree);
  EXPECT_GT(turning.right, 300 * kDegree);
  double travelled = 0;
  for (double t = 0; t < seconds; t += 0.1) {
    travelled += (robot.base_at(t + 0.1).t - robot.base_at(t).t).norm();
    const Vec3 place = robot.base_at(t).t;
    EXPECT_LT(std::max(std::abs(place.x()), std::abs(place.y())), 1.5) << "away from furniture";
    const SE3 T_CO = robot.cameraAt(t).inverse() * robot.objectAt(t);
    ASSERT_LT(T_CO.t.z(), -0.2) << "the carton must stay behind the camera";
  }
  EXPECT_GT(travelled, 8);
  EXPECT_EQ(robot.joints_at(0), robot.joints_at(seconds)) << "the camera is fixed on the base";
}

TEST(CalibrationScenes, GraspTurnsTheCartonBeforeAStandingCamera) {
  const World world = buildWorld("calibrate_grasp", 1);
  const Manipulator& robot = *world.robot;
  const double seconds = world.frames / kFrameRate;
  EXPECT_EQ(robot.cameraAt(0), robot.cameraAt(seconds));
  const auto carton = [&](double t) { return robot.cameraAt(t).inverse() * robot.objectAt(t); };
  const Turning turning = turningOf(carton, seconds);
  EXPECT_GT(turning.all, 300 * kDegree);
  EXPECT_GT(turning.all, 1.2 * (turning.left + turning.right)) << "about more than one axis";
  for (double t = 0; t < seconds; t += 0.1) {
    EXPECT_GT(carton(t).t.z(), 0.6);
    EXPECT_LT(carton(t).t.z(), 0.95);
  }
}

TEST(JointEncoders, StepAndKeepTheirOffsets) {
  const EncoderModel model;
  const JointEncoders encoders(model, 3);
  const double arm_step = 2 * 180 * kDegree / (1 << model.arm_bits);
  double low = 1, high = -1;
  for (int i = 0; i < 200; ++i) {
    const double q = 0.3 + 1e-4 * i;
    const JointPositions read = encoders.read({{"arm_1", q}, {"finger", 0.05}, {"head_pan", q}});
    const double steps = read.at("arm_1") / arm_step;
    EXPECT_NEAR(steps, std::round(steps), 1e-6);
    low = std::min(low, read.at("arm_1") - q);
    high = std::max(high, read.at("arm_1") - q);
    EXPECT_NEAR(read.at("finger"), 0.05, model.finger_step);
  }
  EXPECT_GT(high - low, 0.8 * arm_step);
  EXPECT_LT(high - low, 1.001 * arm_step) << "a constant offset and one step";
  EXPECT_EQ(encoders.read({{"arm_1", 0.3}}).size(), 1U);
}

TEST(InverseKinematics, ReachesAndSaysWhenItDoesNot) {
  const RobotModel model = RobotModel::fromUrdf(robotUrdf(), "robot");
  JointPositions q;
  for (const std::string& joint : model.movableJoints()) q[joint] = 0.2;
  JointPositions other = q;
  other["arm_2"] += 0.4;
  other["arm_5"] -= 0.3;
  const SE3 wanted = model.T_AB(kBaseLink, kGripperLink, other);
  const JointPositions found = solveInverse(model, kBaseLink, kGripperLink, wanted, q);
  EXPECT_LT((model.T_AB(kBaseLink, kGripperLink, found).inverse() * wanted).log().norm(), 1e-4);
  EXPECT_EQ(found.at("head_pan"), 0.2);
  EXPECT_THROW(solveInverse(model, kBaseLink, kGripperLink,
                            SE3(Eigen::Quaterniond::Identity(), Vec3(9, 0, 0)), q),
               std::invalid_argument);
}

}  // namespace
}  // namespace rf::sim
