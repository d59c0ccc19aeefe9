// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinematics/robot_model.hpp"
#include "priors/base_odometry.hpp"
#include "priors/grasp_timeline.hpp"
#include "priors/joint_buffer.hpp"
#include "priors/prior_config.hpp"
#include "priors/robot_covariance.hpp"
#include "values/motion_prior.hpp"

namespace rf {

/// Priors of a robot that carries the camera, from its odometry, joints and grasps:
///   camera  T_WC(t) = T_WB(t) T_BC(q(t))   fixed to the base, on a head, or in the hand
///   object  T_CO(t) = T_CG(q(t)) T_GO      while it is held (ObjectPriorKind::kCameraFrame)
///   self    the collision shapes of every link in the camera frame
/// Samples come in by `odometry()`, `joints()`, `grasps()`; those objects say what is wrong with
/// them. What is missing, late, frozen or jumps is flagged with a reason. Copyable, not
/// thread-safe.
class RobotPrior {
 public:
  /// Throws KinematicsError when a link or wheel joint of the configuration does not exist or a
  /// chain cannot be computed.
  RobotPrior(RobotModel robot, const PriorConfig& config);

  BaseOdometry& odometry() { return odometry_; }
  JointBuffer& joints() { return joints_; }
  GraspTimeline& grasps() { return grasps_; }
  const BaseOdometry& odometry() const { return odometry_; }
  const JointBuffer& joints() const { return joints_; }
  const GraspTimeline& grasps() const { return grasps_; }
  const RobotModel& model() const { return robot_; }
  bool hasGripper() const { return !config_.gripper_link.empty(); }

  /// Fills the camera's part for the pair (prior.utime_a, prior.utime_b); returns why it is not
  /// valid, empty when it is.
  std::string fillCamera(MotionPrior& prior) const;
  /// Fills the object's part; the same. An object that is not held has no prior, and no reason.
  std::string fillObject(MotionPrior& prior) const;
  /// Fills `self` with the shapes whose joints are known at prior.utime_b.
  void fillSelf(MotionPrior& prior) const;

  /// T_WC at a time when it is known without extrapolation.
  std::optional<SE3> cameraPose(std::int64_t utime) const;
  /// True when odometry and the joints of the camera's (and gripper's) chain have samples at or
  /// after that time: waiting longer brings nothing new.
  bool covers(std::int64_t utime) const;
  /// What can never work with the samples at hand, for a message before the run: joints that the
  /// chains need and no sample names, no odometry.
  std::vector<std::string> complaints() const;

 private:
  struct Ends {
    JointsAt a, b;
  };
  Ends jointsAt(const MotionPrior& prior, std::span<const std::string> joints) const;
  std::string flaw(const MotionPrior& prior) const;
  std::string frozen(std::int64_t a, std::int64_t b) const;
  PoseAt baseAt(std::int64_t utime) const;

  RobotModel robot_;
  RobotConfig config_;
  double max_gap_;
  double max_extrapolation_;
  std::vector<std::string> camera_joints_;
  std::vector<std::string> gripper_joints_;
  std::vector<std::string> wheels_;
  BaseOdometry odometry_;
  JointBuffer joints_;
  GraspTimeline grasps_;
};

}  // namespace rf
