// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "../kinematics/urdf_text.hpp"

namespace rf {

/// A robot whose camera stands in the base's origin behind a pan joint at 0, with a gripper on a
/// lift that holds something from the fourth pose on. Its odometry is a trajectory (TUM lines).
inline void writeRobotFolder(const std::string& folder, const std::vector<std::string>& poses) {
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name) { return std::ofstream(folder + "/" + name); };
  write("robot.yaml") << "base_link: base\ncamera_link: camera\ngripper_link: gripper\n";
  write("robot.urdf") << urdfRobot(
      urdfLink("base") + urdfLink("camera") +
      urdfLink("gripper", "<collision><geometry><sphere radius='0.05'/></geometry></collision>") +
      urdfJoint("pan", "revolute", "base", "camera", "xyz='0 0 0'",
                "<axis xyz='0 1 0'/>" + urdfLimit()) +
      urdfJoint("lift", "prismatic", "base", "gripper", "xyz='0.1 0.2 0.8'",
                "<axis xyz='0 1 0'/>" + urdfLimit()));
  auto odometry = write("odometry.txt");
  auto joints = write("joints.csv");
  auto grasp = write("grasp.csv");
  joints << "timestamp,pan,lift\n";
  grasp << "timestamp,held,tx,ty,tz,qx,qy,qz,qw\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::string time;
    std::istringstream(poses[i]) >> time;
    odometry << poses[i] << "\n";
    joints << time << ",0," << 0.001 * static_cast<double>(i) << "\n";
    if (i == 3) grasp << time << ",1,0,0,0.1,0,0,0,1\n";
  }
}

}  // namespace rf
