// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "simulation/shapes.hpp"

namespace rf::sim {

/// What a part of the robot is made of.
enum class RobotLook : std::uint8_t { kShell, kDark, kAccent, kMetal, kRubber };

/// A solid that is rendered, in the frame of its link.
struct RobotPart {
  std::string link;
  ShapeKind kind = ShapeKind::kBox;
  Vec3 half = Vec3::Zero();  ///< metres, as Primitive::half
  SE3 T_LP;
  RobotLook look = RobotLook::kShell;
};

/// A mobile manipulator: a base of 0.64 x 0.56 m, a mast with a pan-tilt head that carries the
/// camera 1.12 m above the floor, an arm of six joints (reach 1.0 m) at the front right, a gripper
/// of two fingers. What is rendered is finer than what the description knows, as with real robots:
/// collision shapes are plain solids around the parts.
const std::vector<RobotPart>& robotParts();

/// The robot's description (URDF): links, joints, collision shapes as boxes, cylinders, spheres.
/// Lengths in metres, the base's frame on the floor below its middle, x ahead.
std::string robotUrdf();

inline constexpr const char* kBaseLink = "base_link";
inline constexpr const char* kCameraLink = "camera_optical";  ///< z ahead, x right, y down
inline constexpr const char* kGripperLink = "gripper_link";   ///< z along the fingers, y opens
inline constexpr double kFingerReach = 0.17;  ///< from the gripper's frame to where things are held

}  // namespace rf::sim
