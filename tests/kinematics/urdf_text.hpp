// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rf {

/// A joint in URDF; `rest` is put inside (axis, limit, mimic).
inline std::string urdfJoint(const std::string& name, const std::string& type,
                             const std::string& parent, const std::string& child,
                             const std::string& origin, const std::string& rest = "") {
  return "<joint name='" + name + "' type='" + type + "'><origin " + origin + "/><parent link='" +
         parent + "'/><child link='" + child + "'/>" + rest + "</joint>";
}

inline std::string urdfLink(const std::string& name, const std::string& inside = "") {
  return "<link name='" + name + "'>" + inside + "</link>";
}

inline std::string urdfRobot(const std::string& inside) {
  return "<?xml version='1.0'?><robot name='test'>" + inside + "</robot>";
}

inline std::string urdfLimit() { return "<limit lower='-3' upper='3' effort='1' velocity='1'/>"; }

/// A base with a head (pan revolute, tilt revolute behind a fixed mount, optical frame fixed) and
/// an arm: a lift (prismatic), an elbow (continuous, slanted axis), a gripper with two fingers of
/// which the right mimics the left.
inline std::string urdfManipulator() {
  return urdfRobot(
      urdfLink("base",
               "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' "
               "ixz='0' iyz='0'/></inertial><collision><origin xyz='0 0 0.1'/><geometry>"
               "<cylinder radius='0.3' length='0.2'/></geometry></collision>") +
      urdfLink("mount") + urdfLink("pan_link") +
      urdfLink("tilt_link",
               "<collision><geometry><mesh filename='head.stl'/></geometry>"
               "</collision>") +
      urdfLink("camera") +
      urdfLink("lift_link",
               "<collision><origin xyz='0.1 0 0' rpy='0 0 0.5'/><geometry>"
               "<box size='0.2 0.4 0.6'/></geometry></collision>") +
      urdfLink("gripper", "<collision><geometry><sphere radius='0.07'/></geometry></collision>") +
      urdfLink("left") + urdfLink("right") +
      urdfJoint("mount_joint", "fixed", "base", "mount", "xyz='0.1 0 1.2' rpy='0 0 0.3'") +
      urdfJoint("pan", "revolute", "mount", "pan_link", "xyz='0 0 0.05'",
                "<axis xyz='0 0 2'/>" + urdfLimit()) +
      urdfJoint("tilt", "revolute", "pan_link", "tilt_link", "xyz='0.02 0 0.1'",
                "<axis xyz='0 1 0'/>" + urdfLimit()) +
      urdfJoint("optical", "fixed", "tilt_link", "camera",
                "xyz='0.05 0 0' rpy='-1.5707963267948966 0 -1.5707963267948966'") +
      urdfJoint("lift", "prismatic", "base", "lift_link", "xyz='0.2 0.1 0.5' rpy='0.1 0 0'",
                "<axis xyz='0 0 1'/>" + urdfLimit()) +
      urdfJoint("elbow", "continuous", "lift_link", "gripper", "xyz='0.3 0 0'",
                "<axis xyz='0 0.6 0.8'/>") +
      urdfJoint("left_finger", "prismatic", "gripper", "left", "xyz='0 0.04 0'",
                "<axis xyz='0 1 0'/>" + urdfLimit()) +
      urdfJoint("right_finger", "prismatic", "gripper", "right", "xyz='0 -0.04 0'",
                "<axis xyz='0 1 0'/>" + urdfLimit() +
                    "<mimic joint='left_finger' multiplier='-2' offset='0.01'/>"));
}

}  // namespace rf
