// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "priors/drift_model.hpp"

namespace rf {

/// Where a live robot speaks (rf-prior --robot-live); recordings come as files.
struct RobotChannels {
  std::string odometry = "POSE_BODY";
  std::string odometry_type = "pose_t";
  std::string joints = "CORE_ROBOT_STATE";
  std::string joints_type = "joint_state_t";
  std::string grasp = "RF_GRASP";

  template <class V>
  void visit(V& v) {
    v("odometry", odometry, "-", "channel of the base's motion; empty: none");
    v("odometry_type", odometry_type, "-",
      "pose_t | rigid_transform_t | robot_state_t | planar_twist_t | update_t");
    v("joints", joints, "-", "channel of joint positions; empty: none");
    v("joints_type", joints_type, "-", "joint_state_t | robot_state_t");
    v("grasp", grasp, "-", "channel of grasp_t; empty: none");
  }
};

/// The robot as a source of priors: its URDF, which of its links matter, and what its sensors are
/// worth. Section prior.robot of the configuration, or robot.yaml of a robot folder alone.
struct RobotConfig {
  std::string urdf = "robot.urdf";
  std::string base_link = "base_link";
  std::string camera_link = "camera_optical_frame";
  std::string gripper_link;
  bool fixed_base = false;

  double odometry_offset = 0;
  double joints_offset = 0;
  double grasp_offset = 0;
  double wheel_scale = 1;
  double turn_scale = 1;

  DriftModel base_drift{0.005, 0.005, 0.02, 0.02};
  DriftModel grasp_drift{0.002, 0.01, 0.0, 0.0};
  double encoder_sigma = 0.001;
  double slide_sigma = 0.0005;

  double max_speed = 3;
  double max_turn = 6;
  double max_joint_speed = 20;
  std::string wheel_joints;
  double frozen_after = 0.2;
  double frozen_speed = 0.05;

  RobotChannels channels;

  template <class V>
  void visit(V& v) {
    v("urdf", urdf, "-", "file, relative to the robot folder");
    v("base_link", base_link, "-", "link whose motion the odometry reports");
    v("camera_link", camera_link, "-", "optical frame: x right, y down, z forward");
    v("gripper_link", gripper_link, "-", "link that a held object moves with; empty: none");
    v("fixed_base", fixed_base, "-", "the base does not move: no odometry is asked for");
    v("odometry_offset", odometry_offset, -10.0, 10.0, "s", "added to the odometry's time stamps");
    v("joints_offset", joints_offset, -10.0, 10.0, "s", "added to the joints' time stamps");
    v("grasp_offset", grasp_offset, -10.0, 10.0, "s", "added to the time stamps of grasps");
    v("wheel_scale", wheel_scale, 0.5, 2.0, "-", "metres travelled for each metre of odometry");
    v("turn_scale", turn_scale, 0.5, 2.0, "-", "radians turned for each radian of odometry");
    v("base_drift", base_drift, "drift of the odometry");
    v("grasp_drift", grasp_drift, "how a held object slips in the gripper");
    v("encoder_sigma", encoder_sigma, 0.0, 1.0, "rad", "error of each turning joint's position");
    v("slide_sigma", slide_sigma, 0.0, 1.0, "m", "error of each sliding joint's position");
    v("max_speed", max_speed, 1e-3, 100.0, "m/s", "the base cannot be faster: more is a jump");
    v("max_turn", max_turn, 1e-3, 100.0, "rad/s", "the base cannot turn faster: more is a jump");
    v("max_joint_speed", max_joint_speed, 1e-3, 1000.0, "rad/s or m/s",
      "no joint can be faster: more is a jump");
    v("wheel_joints", wheel_joints, "-",
      "joints of wheels, comma-separated: where they turn, odometry that stands still is frozen");
    v("frozen_after", frozen_after, 0.0, 60.0, "s",
      "how long the odometry may stand still although it or a wheel says that the base moves");
    v("frozen_speed", frozen_speed, 0.0, 10.0, "m/s or rad/s",
      "above this the odometry's own velocity, or a wheel's, says that the base moves");
    v("channels", channels, "where a live robot speaks");
  }
};

}  // namespace rf
