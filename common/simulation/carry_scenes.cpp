// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/carry_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "simulation/arm_motion.hpp"
#include "simulation/builder.hpp"
#include "simulation/manipulator.hpp"
#include "simulation/robot_description.hpp"

namespace rf::sim {
namespace {

constexpr double kTrackRate = 30.0;           // samples of the joints a second
constexpr double kGraspDepth = 0.045;         // of the fingers' middle inside the carton's edge
constexpr double kOpening = 0.02;             // of each finger before it closes
constexpr double kRetreat = 0.16;             // of the open gripper before it approaches
constexpr double kLateralSlip = 0.04;         // seconds, of the base on two wheels
const Vec3 kCartonHalf = {0.06, 0.23, 0.18};  // metres

/// What one scene does.
struct CarryPlan {
  bool omnidirectional = true;
  SE3 start;  ///< T_WB
  BaseTrack::Speeds speeds;
  Profile distance;        ///< of the carton's face from the camera at the usual head pose
  Profile effort;          ///< how briskly the arm waves the carton
  Vec3 wave;               ///< amplitudes to the right, down, metres, and of the carton's turns
  double grasp_angle = 0;  ///< of the gripper's approach from straight up, towards the left
  Vec3 grasp_point;        ///< on the carton's edge, carton frame
  double grasp_time = 0;   ///< the fingers are closed then
  double lift = 0;         ///< metres upwards after the grasp
  Profile pan, tilt;       ///< of the head, radians
  bool tucked = false;     ///< the arm keeps the carton behind the base, out of the view
};

/// The gripper in the carton's frame: fingers along the approach, opening along the carton's x.
SE3 graspOf(const CarryPlan& plan) {
  const Vec3 along(0, std::sin(plan.grasp_angle), std::cos(plan.grasp_angle));
  Mat3 R_OG;
  R_OG.col(1) = Vec3::UnitX();
  R_OG.col(2) = along;
  R_OG.col(0) = R_OG.col(1).cross(along);
  return {R_OG, Vec3(plan.grasp_point - (kFingerReach - kGraspDepth) * along)};
}

/// Where the carton is to be at a time, in the base's frame.
SE3 wantedCarton(const CarryPlan& plan, const SE3& T_BC, double t) {
  const double held = std::max(t, plan.grasp_time);
  const double s = plan.effort.integral(held);
  Mat3 R_CO;  // faces the camera: x ahead, y left, z up
  R_CO << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Eigen::Quaterniond turn =
      Eigen::AngleAxisd(plan.wave.z() * std::sin(0.8 * s), Vec3::UnitZ()) *
      Eigen::AngleAxisd(0.6 * plan.wave.z() * std::sin(0.7 * s), Vec3::UnitY()) *
      Eigen::AngleAxisd(0.7 * plan.wave.z() * std::sin(0.6 * s), Vec3::UnitX());
  const double rise =
      plan.lift * Profile({{plan.grasp_time + 0.2, 0}, {plan.grasp_time + 1.6, 1}}).at(held);
  const Vec3 place(plan.wave.x() * std::sin(0.9 * s), plan.wave.y() * std::sin(1.1 * s) - rise,
                   plan.distance.at(held) + kCartonHalf.x());
  return T_BC * SE3(R_CO, place) * SE3(turn, Vec3::Zero());
}

JointPositions initialGuess() {
  return {{"head_pan", 0},  {"head_tilt", 0.18}, {"arm_1", 0},   {"arm_2", 2.2}, {"arm_3", -2.1},
          {"arm_4", -1.57}, {"arm_5", 0.6},      {"arm_6", 1.5}, {"finger", 0}};
}

/// Takes whole turns out of the first pose.
void unwind(JointPositions& q) {
  for (auto& [name, value] : q) value = std::remainder(value, 2 * std::numbers::pi);
}

/// The arm turned to the back: camera and carton do not see each other.
JointPositions tuckedJoints() {
  return {{"head_pan", 0}, {"head_tilt", 0.18}, {"arm_1", -2.6},
          {"arm_2", 1.3},  {"arm_3", 0.6},      {"arm_4", 0},
          {"arm_5", 0.9},  {"arm_6", 0},        {"finger", kCartonHalf.x()}};
}

/// The joints of the whole scene: head by its profiles, arm by inverse kinematics.
JointTrack jointTrack(const RobotModel& model, const CarryPlan& plan, double seconds) {
  if (plan.tucked) return {kTrackRate, {tuckedJoints()}};
  JointPositions usual = initialGuess();
  const SE3 T_BC = model.T_AB(kBaseLink, kCameraLink, usual);
  const SE3 T_OG = graspOf(plan);
  const double closed = kCartonHalf.x();
  const double g = plan.grasp_time;
  const Profile opening =
      g > 0 ? Profile({{g - 0.5, closed + kOpening}, {g - 0.05, closed}}) : Profile({{0, closed}});
  const Profile retreat = g > 0 ? Profile({{1.0, kRetreat}, {g - 0.6, 0}}) : Profile({{0, 0}});
  std::vector<JointPositions> samples;
  JointPositions q = usual;
  for (int i = 0; i <= static_cast<int>(seconds * kTrackRate); ++i) {
    const double t = i / kTrackRate;
    q["head_pan"] = plan.pan.at(t);
    q["head_tilt"] = plan.tilt.at(t);
    q["finger"] = opening.at(t);
    const SE3 back(Eigen::Quaterniond::Identity(), {0, 0, -retreat.at(t)});
    q = solveInverse(model, kBaseLink, kGripperLink, wantedCarton(plan, T_BC, t) * T_OG * back, q);
    if (i == 0) unwind(q);
    samples.push_back(q);
  }
  return {kTrackRate, std::move(samples)};
}

CarryPlan omniPlan() {
  return {.omnidirectional = true,
          .start = bodyPose({-1.45, -0.7}, 0.1),
          .speeds = {Profile({{1.0, 0},
                              {2.2, 0.16},
                              {5.0, 0.16},
                              {6.2, 0},
                              {8.5, 0},
                              {9.7, 0.15},
                              {12.4, 0.13},
                              {13.8, 0}}),
                     Profile({{1.0, 0},
                              {2.5, 0.05},
                              {4.5, 0.2},
                              {7.5, 0.2},
                              {9.2, -0.05},
                              {12.0, -0.12},
                              {13.8, 0}}),
                     Profile({{1.5, 0},
                              {3.0, 0.12},
                              {5.5, 0.12},
                              {7.5, -0.18},
                              {10.0, -0.18},
                              {11.5, 0.12},
                              {12.8, 0.12},
                              {14.0, 0}})},
          .distance = Profile(
              {{1.0, 0.66}, {3.5, 0.51}, {6.0, 0.60}, {8.5, 0.76}, {10.5, 0.66}, {13.2, 0.53}}),
          .effort = Profile({{1.0, 0}, {2.0, 1}, {13.0, 1}, {14.0, 0}}),
          .wave = {0.05, 0.03, 0.25},
          .grasp_angle = 0.6,
          .grasp_point = {0, -0.06, -0.18},
          .grasp_time = 0,
          .lift = 0,
          .pan = Profile({{0, 0}}),
          .tilt = Profile({{0, 0.18}})};
}

CarryPlan diffPlan() {
  return {.omnidirectional = false,
          .start = bodyPose({-1.7, -0.55}, 0.15),
          .speeds = {Profile({{3.6, 0}, {4.9, 0.26}, {12.8, 0.26}, {14.2, 0}}), Profile({{0, 0}}),
                     Profile({{4.2, 0},
                              {5.6, 0.28},
                              {7.0, 0.24},
                              {8.6, -0.3},
                              {10.4, -0.3},
                              {11.8, 0.2},
                              {13.0, 0.2},
                              {14.2, 0}})},
          .distance = Profile({{2.6, 0.68}, {4.6, 0.72}, {7.0, 0.52}, {9.5, 0.66}, {13.0, 0.51}}),
          .effort = Profile({{4.2, 0}, {5.4, 1}, {13.0, 1}, {14.0, 0}}),
          .wave = {0.04, 0.03, 0.2},
          .grasp_angle = 1.1,
          .grasp_point = {0, -0.23, -0.08},
          .grasp_time = 2.6,
          .lift = 0.05,
          .pan = Profile({{0, 0}}),
          .tilt = Profile({{0, 0.18}})};
}

CarryPlan headPlan() {
  CarryPlan plan = omniPlan();
  plan.start = bodyPose({-1.4, 0.7}, -0.15);
  plan.speeds = {
      Profile({{1.0, 0}, {2.4, 0.2}, {6.0, 0.2}, {8.0, 0.06}, {12.5, 0.16}, {14.0, 0}}),
      Profile({{2.0, 0}, {3.5, -0.1}, {8.0, -0.16}, {11.0, -0.06}, {13.5, 0}}),
      Profile({{1.5, 0}, {4.0, -0.1}, {7.0, 0.12}, {10.0, 0.12}, {12.0, -0.1}, {14.0, 0}})};
  plan.distance =
      Profile({{1.0, 0.66}, {4.0, 0.54}, {7.0, 0.68}, {10.0, 0.52}, {12.0, 0.53}, {13.5, 0.62}});
  plan.wave = {0.03, 0.02, 0.18};
  plan.pan = Profile({{1.0, 0}, {3.0, 0.22}, {5.2, -0.16}, {7.5, 0.25}, {10.0, -0.2}, {13.0, 0.1}});
  plan.tilt = Profile({{1.5, 0.18}, {4.0, 0.28}, {6.5, 0.10}, {9.0, 0.26}, {12.5, 0.14}});
  return plan;
}

/// Stands and waves the carton about all axes, so far away that most of the view is room.
CarryPlan graspPlan() {
  CarryPlan plan = omniPlan();
  plan.speeds = {Profile({{0, 0}}), Profile({{0, 0}}), Profile({{0, 0}})};
  plan.distance = Profile({{1.0, 0.74},
                           {5.0, 0.62},
                           {9.0, 0.76},
                           {13.0, 0.64},
                           {17.0, 0.76},
                           {21.0, 0.62},
                           {25.0, 0.74},
                           {28.0, 0.66}});
  plan.effort = Profile({{1.0, 0}, {2.0, 1}, {28.0, 1}, {29.0, 0}});
  plan.wave = {0.07, 0.05, 0.45};
  return plan;
}

/// Circles to the left, the right, the left, with slower parts and stops, then forth and back.
CarryPlan drivePlan() {
  CarryPlan plan = omniPlan();
  plan.tucked = true;
  plan.start = bodyPose({-0.2, 0.0}, 0.0);
  std::vector<std::pair<double, double>> ahead;
  std::vector<std::pair<double, double>> turning;
  for (int k = 0; k < 3; ++k) {
    const double t = 15.5 * k;
    const double side = k == 1 ? -1 : 1;
    for (const auto& [after, v] : {std::pair{1.0, 0.0},
                                   {2.0, 0.28},
                                   {6.5, 0.28},
                                   {8.0, 0.14},
                                   {9.5, 0.30},
                                   {14.5, 0.28},
                                   {16.0, 0.0}}) {
      ahead.emplace_back(t + after, v);
    }
    for (const auto& [after, w] : {std::pair{1.2, 0.0}, {3.0, 0.46}, {14.0, 0.46}, {16.2, 0.0}}) {
      turning.emplace_back(t + after, side * w);
    }
  }
  for (const auto& [t, v] : {std::pair{47.5, 0.0},
                             {48.5, 0.25},
                             {50.5, 0.25},
                             {51.5, 0.0},
                             {53.0, -0.25},
                             {55.0, -0.25},
                             {56.5, 0.0}}) {
    ahead.emplace_back(t, v);
  }
  plan.speeds = {Profile(ahead), Profile({{0, 0}}), Profile(turning)};
  return plan;
}

int materialOf(Builder& b, RobotLook look) {
  switch (look) {
    case RobotLook::kShell:
      return b.plain({222, 222, 216}, 0.6F, 0.12F);
    case RobotLook::kDark:
      return b.plain({52, 54, 58}, 0.35F, 0.1F);
    case RobotLook::kAccent:
      return b.plain({226, 112, 30}, 0.55F, 0.1F);
    case RobotLook::kMetal:
      return b.plain({150, 152, 156}, 0.5F, 0.2F);
    case RobotLook::kRubber:
      break;
  }
  return b.plain({30, 30, 32}, 0.25F);
}

/// Renders the parts of each link as a body of its own.
void buildLinks(World& world, Manipulator& robot, std::uint64_t seed) {
  Builder b(world, seed, 0x20B0700ULL);
  std::map<RobotLook, int> materials;
  for (const RobotPart& part : robotParts()) {
    auto link = std::find(robot.links.begin(), robot.links.end(), part.link);
    if (link == robot.links.end()) link = robot.links.insert(robot.links.end(), part.link);
    const auto body = robot.first_body + static_cast<int>(link - robot.links.begin());
    if (!materials.contains(part.look)) materials[part.look] = materialOf(b, part.look);
    b.solid(part.kind, body, part.T_LP, part.half, materials[part.look]);
  }
  world.bodies = robot.first_body + static_cast<int>(robot.links.size());
}

/// What the carton stands on until it is grasped: a narrow post with a plate.
void buildStand(World& world, const SE3& T_WO, std::uint64_t seed) {
  Builder b(world, seed, 0x57A2DULL);
  const double top = T_WO.t.z() - kCartonHalf.z() - 0.008;
  const Vec3 foot(T_WO.t.x(), T_WO.t.y(), 0);
  const int wood = b.plain({150, 112, 74}, 0.55F, 0.05F);
  b.rod(foot, Vec3(foot + Vec3(0, 0, 0.03)), 0.17, wood);
  b.rod(foot, Vec3(foot + Vec3(0, 0, top - 0.02)), 0.035, b.plain({90, 92, 96}, 0.5F, 0.1F));
  b.rod(Vec3(foot + Vec3(0, 0, top - 0.02)), Vec3(foot + Vec3(0, 0, top)), 0.10, wood);
}

void drive(World& world, std::shared_ptr<const Manipulator> robot) {
  world.camera_at = [robot](double t) { return robot->cameraAt(t); };
  world.body_at.emplace_back([robot](double t) { return robot->objectAt(t); });
  for (const std::string& link : robot->links) {
    world.body_at.emplace_back([robot, link](double t) {
      return robot->base_at(t) * robot->model.T_AB(kBaseLink, link, robot->joints_at(t));
    });
  }
  world.robot = std::move(robot);
}

}  // namespace

void buildCarryScene(World& world, const std::string& scene, std::uint64_t seed) {
  static const std::map<std::string, CarryPlan (*)()> kPlans = {{"carry_omni", omniPlan},
                                                                {"carry_diff", diffPlan},
                                                                {"carry_head", headPlan},
                                                                {"calibrate_drive", drivePlan},
                                                                {"calibrate_grasp", graspPlan}};
  const auto found = kPlans.find(scene);
  if (found == kPlans.end()) return;
  const CarryPlan plan = found->second();
  const double seconds = world.frames / kFrameRate;
  const double slip = plan.omnidirectional ? 0.0 : kLateralSlip;
  const auto base = std::make_shared<BaseTrack>(plan.start, plan.speeds, slip, seconds);
  Manipulator robot{.model = RobotModel::fromUrdf(robotUrdf(), "robot of rf-simulate"),
                    .omnidirectional = plan.omnidirectional,
                    .base_at = [base](double t) { return base->poseAt(t); },
                    .twist_at = [base](double t) { return base->twistAt(t); },
                    .joints_at = {},
                    .grasp_time = plan.grasp_time,
                    .T_GO = graspOf(plan).inverse(),
                    .links = {},
                    .first_body = 2};
  const auto joints = std::make_shared<JointTrack>(jointTrack(robot.model, plan, seconds));
  robot.joints_at = [joints](double t) { return joints->at(t); };
  buildCarton(world, 1, kCartonHalf, seed);
  buildLinks(world, robot, seed);
  if (plan.grasp_time > 0) buildStand(world, robot.objectAt(0), seed);
  drive(world, std::make_shared<const Manipulator>(std::move(robot)));
}

}  // namespace rf::sim
