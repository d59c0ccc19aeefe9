// SPDX-License-Identifier: BSD-3-Clause
#include "robot_writer.hpp"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "simulation/joint_encoders.hpp"
#include "simulation/manipulator.hpp"
#include "simulation/robot_description.hpp"
#include "simulation/simulator.hpp"
#include "simulation/wheels.hpp"
#include "text_files.hpp"

namespace rf {
namespace {

constexpr double kRate = 100.0;  // of wheels and joints, Hz
constexpr double kMargin = 0.5;  // recorded before the first and after the last frame, seconds

std::int64_t utimeOf(double seconds) { return sim::kStartUtime + std::llround(seconds * 1e6); }

std::string jointRow(double seconds, const JointPositions& q) {
  std::string row = stampText(utimeOf(seconds));
  for (const auto& [name, value] : q) row += fmt::format(",{:.9f}", value);
  return row + "\n";
}

std::string jointHeader(const JointPositions& q) {
  std::string row = "timestamp";
  for (const auto& [name, value] : q) row += "," + name;
  return row + "\n";
}

std::string graspRow(double seconds, bool held, const SE3& T) {
  return fmt::format("{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n",
                     stampText(utimeOf(seconds)), held ? 1 : 0, T.t.x(), T.t.y(), T.t.z(), T.q.x(),
                     T.q.y(), T.q.z(), T.q.w());
}

std::string graspText(const sim::Manipulator& robot) {
  std::string text = "timestamp,held,tx,ty,tz,qx,qy,qz,qw\n";
  text += graspRow(-kMargin, robot.held(-kMargin) || robot.grasp_time <= 0,
                   robot.grasp_time <= 0 ? robot.T_GO : SE3());
  if (robot.grasp_time > 0) text += graspRow(robot.grasp_time, true, robot.T_GO);
  return text;
}

std::string configText() {
  return fmt::format(
      "# The robot of rf-simulate: how its recordings become priors.\n"
      "urdf: robot.urdf\nbase_link: {}\ncamera_link: {}\ngripper_link: {}\n",
      sim::kBaseLink, sim::kCameraLink, sim::kGripperLink);
}

}  // namespace

void writeRobot(const std::filesystem::path& folder, const sim::World& world, std::uint64_t seed) {
  const sim::Manipulator& robot = *world.robot;
  std::filesystem::create_directories(folder);
  const double end = world.frames / sim::kFrameRate + kMargin;
  writeText(folder / "robot.urdf", sim::robotUrdf());
  writeText(folder / "robot.yaml", configText());
  writeText(folder / "grasp.csv", graspText(robot));
  const std::string header = "# timestamp tx ty tz qx qy qz qw\n";
  std::string odometry = "# T_WB of the base by its wheels\n" + header;
  std::string truth = "# true T_WB of the base\n" + header;
  for (const auto& [t, pose] : sim::wheelOdometry(robot, {}, -kMargin, end, kRate, seed)) {
    odometry += tumLine(utimeOf(t), pose);
    truth += tumLine(utimeOf(t), robot.base_at(t));
  }
  writeText(folder / "odometry.txt", odometry);
  writeText(folder / "base_groundtruth.txt", truth);
  const sim::JointEncoders encoders({}, seed);
  std::string joints = jointHeader(robot.joints_at(0));
  std::string true_joints = joints;
  for (int k = 0; - kMargin + k / kRate <= end + 1e-9; ++k) {
    const double t = -kMargin + k / kRate;
    const JointPositions q = robot.joints_at(t);
    joints += jointRow(t, encoders.read(q));
    true_joints += jointRow(t, q);
  }
  writeText(folder / "joints.csv", joints);
  writeText(folder / "joints_groundtruth.csv", true_joints);
}

}  // namespace rf
