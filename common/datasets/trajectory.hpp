// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "values/stamped_pose.hpp"

namespace rf {

/// Reads a trajectory in TUM text: `timestamp tx ty tz qx qy qz qw` per line, seconds and metres,
/// # comments; further words are ignored. Throws DatasetError naming file and line for a missing or
/// unreadable number, NaN or infinity, a quaternion that is not of unit length, and time that does
/// not increase. An empty file gives an empty trajectory.
Trajectory readTrajectory(const std::string& path);

/// One line without line break: time with 6 decimals, pose with 9 decimals; -0 is written as 0.
std::string formatTumPose(std::int64_t utime, const SE3& pose);

/// Writes a trajectory line by line, each flushed, so that a crash loses nothing that was added.
class TrajectoryWriter {
 public:
  /// Replaces the file. `comment` becomes the first line. Throws DatasetError.
  TrajectoryWriter(const std::string& path, const std::string& comment);
  /// Throws DatasetError when the pose is not finite or the line cannot be written.
  void add(std::int64_t utime, const SE3& pose);

 private:
  std::string path_;
  std::ofstream file_;
};

}  // namespace rf
