// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kinematics/robot_model.hpp"
#include "simulation/base_track.hpp"

namespace rf::sim {

/// The robot of a scene and what it truly does: the camera, the held object and the robot's own
/// links follow from it.
struct Manipulator {
  RobotModel model;
  bool omnidirectional = true;                      ///< four mecanum wheels, else two driven wheels
  std::function<SE3(double)> base_at;               ///< T_WB at a time in seconds
  std::function<PlanarTwist(double)> twist_at;      ///< of the base, in its frame
  std::function<JointPositions(double)> joints_at;  ///< of every movable joint
  double grasp_time = 0;  ///< from then on the object is held; not positive: from the start
  SE3 T_GO;               ///< the held object in the gripper's frame
  std::vector<std::string> links;  ///< that are rendered, in the order of their bodies
  int first_body = 2;              ///< body of links[0]

  bool held(double t) const { return t >= grasp_time; }
  SE3 cameraAt(double t) const;  ///< T_WC
  SE3 objectAt(double t) const;  ///< T_WO; rests where it is grasped until then
};

}  // namespace rf::sim
