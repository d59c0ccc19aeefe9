// SPDX-License-Identifier: BSD-3-Clause
#include "robot_input.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

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

JointPositions positionsOf(const JointTable& table, const JointTable::Row& row) {
  JointPositions q;
  for (std::size_t k = 0; k < table.joints.size(); ++k) q[table.joints[k]] = row.positions[k];
  return q;
}

/// T_AB over the rows of the table.
Trajectory along(const RobotModel& model, const JointTable& table, const std::string& a,
                 const std::string& b) {
  Trajectory out;
  out.reserve(table.rows.size());
  for (const JointTable::Row& row : table.rows) {
    out.push_back({row.utime, model.T_AB(a, b, positionsOf(table, row))});
  }
  return out;
}

/// T_AB when no joint between moves; `table` may be empty when there is no joint at all.
SE3 fixedPose(const RobotModel& model, const JointTable& table, const std::string& a,
              const std::string& b) {
  const std::vector<std::string> joints = model.jointsBetween(a, b);
  if (joints.empty()) return model.T_AB(a, b, {});
  if (table.rows.empty()) {
    throw DatasetError(fmt::format("joints.csv: has no row, but {} depends on {}", b, joints[0]));
  }
  for (const std::string& joint : joints) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const JointTable::Row& row : table.rows) {
      const JointPositions q = positionsOf(table, row);
      const auto at = q.find(joint);
      if (at == q.end()) throw DatasetError("joints.csv: column " + joint + " is missing");
      low = std::min(low, at->second);
      high = std::max(high, at->second);
    }
    if (high - low > kStill) {
      throw DatasetError(
          fmt::format("joints.csv: {} moves by {:.4f} between {} and {}: must stay still within {}",
                      joint, high - low, a, b, kStill));
    }
  }
  return model.T_AB(a, b, positionsOf(table, table.rows.front()));
}

std::vector<std::pair<std::int64_t, std::int64_t>> heldTimes(const fs::path& path) {
  std::vector<std::pair<std::int64_t, std::int64_t>> held;
  if (!fs::exists(path)) return held;
  bool holding = false;
  for (const Grasp& grasp : readGrasps(path.string())) {
    if (grasp.held && !holding) {
      held.emplace_back(grasp.utime, std::numeric_limits<std::int64_t>::max());
    }
    if (!grasp.held && holding) held.back().second = grasp.utime;
    holding = grasp.held;
  }
  return held;
}

JointTable jointsIfThere(const fs::path& path) {
  return fs::exists(path) ? readJoints(path.string()) : JointTable();
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
  if (problem == Problem::kOdometry) {
    input.moving = readTrajectory((root / "odometry.txt").string());
    input.extrinsic =
        fixedPose(model, jointsIfThere(root / "joints.csv"), robot.base_link, robot.camera_link);
    return input;
  }
  needGripper(robot, folder);
  const JointTable joints = readJoints((root / "joints.csv").string());
  if (problem == Problem::kHandEye) {
    input.moving = along(model, joints, robot.base_link, robot.gripper_link);
    if (model.jointsBetween(robot.gripper_link, robot.camera_link).empty()) {
      input.extrinsic = model.T_AB(robot.gripper_link, robot.camera_link, {});
    }
    return input;
  }
  input.moving = along(model, joints, robot.camera_link, robot.gripper_link);
  input.held = heldTimes(root / "grasp.csv");
  return input;
}

}  // namespace rf
