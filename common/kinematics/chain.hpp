// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <kdl/chain.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinematics/robot_model.hpp"

namespace rf {

/// A joint's position as a function of the joint that moves by itself:
/// multiplier * q[master] + offset.
struct JointLaw {
  std::string master;
  double multiplier = 1;
  double offset = 0;
};
/// By the name of every revolute, continuous and prismatic joint.
using JointLaws = std::map<std::string, JointLaw>;

/// KDL's view of a chain: from its base to its tip, with the position of each joint on the way.
/// Throws KinematicsError, naming `source`, when `q` lacks a joint or it is not finite.
SE3 chainPose(const KDL::Chain& chain, const JointLaws& laws, const JointPositions& q,
              const std::string& source);
/// Derivative of chainPose by the joints that move by themselves.
RobotJacobian chainJacobian(const KDL::Chain& chain, const JointLaws& laws, const JointPositions& q,
                            const std::string& source);

}  // namespace rf
