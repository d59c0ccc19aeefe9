// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/robot_folder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "config/yaml.hpp"
#include "datasets/error.hpp"
#include "datasets/robot_files.hpp"
#include "datasets/text.hpp"
#include "datasets/trajectory.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;
constexpr std::uintmax_t kMaxUrdfBytes = 16U << 20U;
constexpr std::size_t kRemarks = 3;  // of one file; the rest is counted

std::string readText(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) throw DatasetError(path.string() + ": cannot be read");
  if (bytes > kMaxUrdfBytes) {
    throw DatasetError(fmt::format("{}: has {} bytes, a URDF may have at most {}", path.string(),
                                   bytes, kMaxUrdfBytes));
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw DatasetError(path.string() + ": cannot be read");
  return text;
}

/// Collects what is said of the samples of one file.
class Remarks {
 public:
  Remarks(std::string file, std::vector<std::string>& out) : file_(std::move(file)), out_(out) {}
  ~Remarks() {
    if (count_ > kRemarks)
      out_.push_back(fmt::format("{}: {} more of that kind", file_, count_ - kRemarks));
  }
  Remarks(const Remarks&) = delete;
  Remarks& operator=(const Remarks&) = delete;
  void add(std::int64_t utime, const std::string& said) {
    if (said.empty() || ++count_ > kRemarks) return;
    out_.push_back(fmt::format("{}: sample at {}: {}", file_, formatTimestamp(utime), said));
  }

 private:
  std::string file_;
  std::vector<std::string>& out_;
  std::size_t count_ = 0;
};

void readOdometry(const fs::path& folder, RobotRecording& to) {
  const fs::path poses = folder / "odometry.txt";
  const fs::path twists = folder / "twist.csv";
  if (fs::exists(poses) && fs::exists(twists)) {
    throw DatasetError(
        fmt::format("{} and {}: only one may be there", poses.string(), twists.string()));
  }
  BaseOdometry& odometry = to.robot.odometry();
  if (fs::exists(poses)) {
    const Trajectory trajectory = readTrajectory(poses.string());
    odometry.reserve(trajectory.size());
    Remarks remarks(poses.string(), to.remarks);
    for (const StampedPose& p : trajectory) remarks.add(p.utime, odometry.addPose(p.utime, p.pose));
  } else if (fs::exists(twists)) {
    const auto samples = readTwists(twists.string());
    odometry.reserve(samples.size());
    Remarks remarks(twists.string(), to.remarks);
    for (const StampedTwist& s : samples) remarks.add(s.utime, odometry.addTwist(s.utime, s.twist));
  }
}

void readJointsInto(const fs::path& path, RobotRecording& to) {
  if (!fs::exists(path)) return;
  const JointTable table = readJoints(path.string());
  to.robot.joints().reserve(table.rows.size());
  Remarks remarks(path.string(), to.remarks);
  for (const JointTable::Row& row : table.rows)
    remarks.add(row.utime, to.robot.joints().add(row.utime, table.joints, row.positions));
}

void readGraspsInto(const fs::path& path, RobotRecording& to) {
  if (!fs::exists(path)) return;
  Remarks remarks(path.string(), to.remarks);
  for (const Grasp& grasp : readGrasps(path.string()))
    remarks.add(grasp.utime, to.robot.grasps().add(grasp));
}

}  // namespace

void loadRobotConfig(const std::string& folder, PriorConfig& config) {
  const fs::path path = fs::path(folder) / "robot.yaml";
  if (fs::exists(path)) loadConfigFile(path.string(), config.robot);
}

RobotPrior openRobot(const std::string& folder, const PriorConfig& config) {
  const fs::path path = fs::path(folder) / config.robot.urdf;
  return {RobotModel::fromUrdf(readText(path), path.string()), config};
}

RobotRecording readRobot(const std::string& folder, const PriorConfig& config) {
  RobotRecording out{openRobot(folder, config), {}};
  readOdometry(folder, out);
  readJointsInto(fs::path(folder) / "joints.csv", out);
  readGraspsInto(fs::path(folder) / "grasp.csv", out);
  for (const std::string& complaint : out.robot.complaints())
    out.remarks.push_back(fmt::format("{}: {}", folder, complaint));
  return out;
}

}  // namespace rf
