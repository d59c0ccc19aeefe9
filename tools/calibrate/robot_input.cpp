// SPDX-License-Identifier: BSD-3-Clause
#include "robot_input.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "datasets/robot_files.hpp"
#include "datasets/robot_folder.hpp"
#include "datasets/trajectory.hpp"
#include "kinematics/robot_model.hpp"
#include "priors/prior_config.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;
using calibration::Problem;

constexpr double kStill = 2e-3;  ///< rad or m that a joint below the camera may move
constexpr std::uintmax_t kMaxUrdfBytes = 16U << 20U;

RobotModel readModel(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || fs::file_size(path) > kMaxUrdfBytes) {
    throw DatasetError(path.string() + ": must be a readable URDF of at most 16 MiB");
  }
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return RobotModel::fromUrdf(text, path.string());
}

/// Poses of the base by its odometry, raw: T_WB, or twists integrated as RobotPrior does (between
/// two samples their mean holds).
Trajectory baseMotion(const fs::path& folder) {
  const fs::path poses = folder / "odometry.txt";
  const fs::path twists = folder / "twist.csv";
  if (fs::exists(poses) && fs::exists(twists)) {
    throw DatasetError(
        fmt::format("{} and {}: only one may be there", poses.string(), twists.string()));
  }
  if (!fs::exists(twists)) return readTrajectory(poses.string());
  Trajectory out;
  PlanarTwist before;
  for (const auto& [utime, twist] : readTwists(twists.string())) {
    SE3 pose;
    if (!out.empty()) {
      const PlanarTwist mean{0.5 * (before.vx + twist.vx), 0.5 * (before.vy + twist.vy),
                             0.5 * (before.wz + twist.wz)};
      pose = out.back().pose * arc(mean, 1e-6 * static_cast<double>(utime - out.back().utime));
    }
    out.push_back({utime, pose});
    before = twist;
  }
  return out;
}

/// A joints.csv with what is said of it.
struct Joints {
  std::string path;
  JointTable table;
};

Joints readJointsOf(const fs::path& folder) {
  const std::string path = (folder / "joints.csv").string();
  return {path, fs::exists(path) ? readJoints(path) : JointTable()};
}

/// Throws unless there is a row, with every joint between the two links.
void needJoints(const RobotModel& model, const Joints& joints, const std::string& a,
                const std::string& b) {
  const std::vector<std::string>& known = joints.table.joints;
  for (const std::string& joint : model.jointsBetween(a, b)) {
    if (joints.table.rows.empty()) {
      throw DatasetError(
          fmt::format("{}: {}, but the pose of {} in {} depends on joint {}", joints.path,
                      fs::exists(joints.path) ? "has no row" : "is missing", b, a, joint));
    }
    if (std::find(known.begin(), known.end(), joint) == known.end()) {
      throw DatasetError(fmt::format("{}: column {} is missing, the pose of {} in {} depends on it",
                                     joints.path, joint, b, a));
    }
  }
}

JointPositions positionsOf(const JointTable& table, const JointTable::Row& row) {
  JointPositions q;
  for (std::size_t k = 0; k < table.joints.size(); ++k) q[table.joints[k]] = row.positions[k];
  return q;
}

/// T_AB over the rows of the table.
Trajectory along(const RobotModel& model, const Joints& joints, const std::string& a,
                 const std::string& b) {
  needJoints(model, joints, a, b);
  Trajectory out;
  out.reserve(joints.table.rows.size());
  for (const JointTable::Row& row : joints.table.rows) {
    out.push_back({row.utime, model.T_AB(a, b, positionsOf(joints.table, row))});
  }
  return out;
}

/// T_AB when no joint between moves; there may be no joints.csv when there is no joint at all.
SE3 fixedPose(const RobotModel& model, const Joints& joints, const std::string& a,
              const std::string& b) {
  needJoints(model, joints, a, b);
  const std::vector<std::string> between = model.jointsBetween(a, b);
  if (between.empty()) return model.T_AB(a, b, {});
  const std::vector<JointTable::Row>& rows = joints.table.rows;
  for (const std::string& joint : between) {
    const std::vector<std::string>& known = joints.table.joints;
    const auto column =
        static_cast<std::size_t>(std::find(known.begin(), known.end(), joint) - known.begin());
    double low = rows.front().positions[column];
    double high = low;
    for (const JointTable::Row& row : rows) {
      low = std::min(low, row.positions[column]);
      high = std::max(high, row.positions[column]);
    }
    if (high - low > kStill) {
      throw DatasetError(
          fmt::format("{}: {} moves by {:.4f} between {} and {}: must stay still within {}",
                      joints.path, joint, high - low, a, b, kStill));
    }
  }
  return model.T_AB(a, b, positionsOf(joints.table, rows.front()));
}

std::vector<std::pair<std::int64_t, std::int64_t>> heldTimes(const fs::path& path) {
  std::vector<std::pair<std::int64_t, std::int64_t>> held;
  bool holding = false;
  for (const Grasp& grasp : readGrasps(path.string())) {
    if (grasp.held && !holding) {
      held.emplace_back(grasp.utime, std::numeric_limits<std::int64_t>::max());
    }
    if (!grasp.held && holding) held.back().second = grasp.utime;
    holding = grasp.held;
  }
  if (held.empty()) {
    throw DatasetError(path.string() +
                       ": no row has held = 1: a grasp is calibrated while the object is held");
  }
  return held;
}

void needGripper(const RobotConfig& robot, const std::string& folder) {
  if (!robot.gripper_link.empty()) return;
  throw DatasetError(folder + "/robot.yaml: gripper_link is not given");
}

}  // namespace

RobotInput readRobotInput(const std::string& folder, Problem problem) {
  PriorConfig config;
  loadRobotConfig(folder, config);
  const RobotConfig& robot = config.robot;
  const fs::path root(folder);
  const RobotModel model = readModel(root / robot.urdf);
  RobotInput input;
  const Joints joints = readJointsOf(root);
  if (problem == Problem::kOdometry) {
    input.moving = baseMotion(root);
    input.extrinsic = fixedPose(model, joints, robot.base_link, robot.camera_link);
    return input;
  }
  needGripper(robot, folder);
  if (problem == Problem::kHandEye) {
    input.moving = along(model, joints, robot.base_link, robot.gripper_link);
    if (model.jointsBetween(robot.gripper_link, robot.camera_link).empty()) {
      input.extrinsic = model.T_AB(robot.gripper_link, robot.camera_link, {});
    }
    return input;
  }
  input.moving = along(model, joints, robot.camera_link, robot.gripper_link);
  if (fs::exists(root / "grasp.csv")) input.held = heldTimes(root / "grasp.csv");
  return input;
}

}  // namespace rf
