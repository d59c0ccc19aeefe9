// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "priors/grasp_timeline.hpp"
#include "priors/planar_twist.hpp"

namespace rf {

/// Files of a robot recording. Readers throw DatasetError naming file, line, column, value and
/// rule: a missing or unreadable number, NaN or infinity, a quaternion that is not of unit length,
/// time that does not increase, a wrong header. Lines that begin with # are comments.

/// `timestamp,<joint>,<joint>...` as header, then seconds and radians (or metres) per row.
struct JointTable {
  std::vector<std::string> joints;
  struct Row {
    std::int64_t utime = 0;
    std::vector<double> positions;
  };
  std::vector<Row> rows;
};
JointTable readJoints(const std::string& path);

/// `timestamp,vx,vy,wz`: twists of the base in its own frame, m/s and rad/s.
struct StampedTwist {
  std::int64_t utime = 0;
  PlanarTwist twist;
};
std::vector<StampedTwist> readTwists(const std::string& path);

/// `timestamp,held,tx,ty,tz,qx,qy,qz,qw`: from that time on the object is held (1) at T_GO in the
/// gripper, or not (0; the pose is then not looked at, but must be there).
std::vector<Grasp> readGrasps(const std::string& path);

}  // namespace rf
