// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "messaging/wire.hpp"
#include "priors/base_odometry.hpp"
#include "priors/grasp_timeline.hpp"
#include "priors/planar_twist.hpp"

namespace rf {

/// What a robot's message says, whatever its type: the parts that are there.
struct RobotSample {
  std::int64_t utime = 0;  ///< microseconds of the robot's clock
  struct BasePose {
    SE3 T_WB;
    std::optional<StatedSpeed> stated;  ///< where the message carries velocities
  };
  std::optional<BasePose> pose;
  std::optional<PlanarTwist> twist;
  struct Increment {
    std::int64_t from_utime = 0;
    SE3 T_prev_now;
  };
  std::optional<Increment> increment;
  struct Joints {
    std::vector<std::string> names;
    std::vector<double> positions;
  };
  std::optional<Joints> joints;
  std::optional<Grasp> grasp;
};

/// The types that odometry may come in: pose_t, rigid_transform_t, robot_state_t, planar_twist_t,
/// update_t. Throws std::invalid_argument, naming `field`, for another.
void checkOdometryType(const std::string& type, const std::string& field);
/// The types that joints may come in: joint_state_t, robot_state_t. The same.
void checkJointsType(const std::string& type, const std::string& field);

/// Decodes a message of one of those types, or grasp_t; fails with the member, its value and the
/// rule. Numbers that are not finite pass where the priors say more of them (joints, twists,
/// poses).
Result<RobotSample> robotSample(const std::string& type, ByteView bytes);

/// For senders: the messages of this project's own types, and joints as bot_core has them.
Bytes packTwist(std::int64_t utime, const PlanarTwist& twist);
Bytes packGrasp(const Grasp& grasp);
Bytes packJoints(std::int64_t utime, const RobotSample::Joints& joints);

}  // namespace rf
