// SPDX-License-Identifier: BSD-3-Clause
#include "priors/robot_prior.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace rf {
namespace {

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> out;
  std::string word;
  for (const char c : list + ",") {
    if (c == ',') {
      if (!word.empty()) out.push_back(word);
      word.clear();
    } else if (c != ' ' && c != '\t') {
      word += c;
    }
  }
  return out;
}

std::vector<std::string> between(const RobotModel& robot, const std::string& a,
                                 const std::string& b) {
  return b.empty() ? std::vector<std::string>() : robot.jointsBetween(a, b);
}

/// Every joint that a chain, a shape or the search for frozen odometry needs.
std::map<std::string, JointKind> wantedJoints(const RobotModel& robot, const RobotConfig& config) {
  std::map<std::string, JointKind> wanted;
  const auto want = [&](const std::vector<std::string>& joints) {
    for (const std::string& joint : joints) wanted[joint] = robot.jointKind(joint);
  };
  want(between(robot, config.base_link, config.camera_link));
  want(between(robot, config.camera_link, config.gripper_link));
  want(split(config.wheel_joints));
  for (const LinkShape& shape : robot.collisionShapes()) {
    try {
      want(robot.jointsBetween(config.camera_link, shape.link));
    } catch (const KinematicsError&) {
      continue;  // behind a floating joint: such a shape is never posed
    }
  }
  return wanted;
}

/// The worst of several looked-up things and its reason.
class Judge {
 public:
  void take(PriorState state, const std::string& reason) {
    const bool worse = (state == PriorState::kMissing && state_ != PriorState::kMissing) ||
                       (state == PriorState::kExtrapolated && state_ == PriorState::kValid);
    if (!worse) return;
    state_ = state;
    reason_ = reason;
  }
  void refuse(const std::string& reason) {
    if (!reason.empty()) take(PriorState::kMissing, reason);
  }
  PriorState state() const { return state_; }
  const std::string& reason() const { return reason_; }

 private:
  PriorState state_ = PriorState::kValid;
  std::string reason_;
};

double secondsOf(const MotionPrior& prior) { return secondsBetween(prior.utime_a, prior.utime_b); }

std::string previous(const std::string& reason) { return "previous frame: " + reason; }

}  // namespace

RobotPrior::RobotPrior(RobotModel robot, const PriorConfig& config)
    : robot_(std::move(robot)),
      config_(config.robot),
      max_gap_(config.max_gap),
      max_extrapolation_(config.max_extrapolation),
      camera_joints_(robot_.jointsBetween(config_.base_link, config_.camera_link)),
      gripper_joints_(between(robot_, config_.camera_link, config_.gripper_link)),
      wheels_(split(config_.wheel_joints)),
      odometry_(config_, max_gap_),
      joints_(wantedJoints(robot_, config_), config_.max_joint_speed, config_.joints_offset),
      grasps_(config_.grasp_offset) {
  joints_.allowAnySpeed(wheels_);
}

PoseAt RobotPrior::baseAt(std::int64_t utime) const {
  if (config_.fixed_base) return {PriorState::kValid, SE3(), {}};
  PoseAt found = odometry_.at(utime, max_gap_, max_extrapolation_);
  if (!found.reason.empty()) found.reason = "odometry: " + found.reason;
  return found;
}

RobotPrior::Ends RobotPrior::jointsAt(const MotionPrior& prior,
                                      std::span<const std::string> joints) const {
  return {joints_.at(prior.utime_a, joints, max_gap_, max_extrapolation_),
          joints_.at(prior.utime_b, joints, max_gap_, max_extrapolation_)};
}

/// Odometry that stands still while a wheel turns.
std::string RobotPrior::frozen(std::int64_t a, std::int64_t b) const {
  const auto still = odometry_.stillFor(a, b);
  if (!still || *still < config_.frozen_after || a == b) return {};
  for (const std::string& wheel : wheels_) {
    const std::vector<std::string> one{wheel};
    const JointsAt at_a = joints_.at(a, one, max_gap_, max_extrapolation_);
    const JointsAt at_b = joints_.at(b, one, max_gap_, max_extrapolation_);
    if (at_a.state == PriorState::kMissing || at_b.state == PriorState::kMissing) continue;
    const double speed = std::abs(at_b.q.at(wheel) - at_a.q.at(wheel)) / secondsBetween(a, b);
    if (speed > config_.frozen_speed) {
      return fmt::format(
          "odometry stands still for {:.3f} s although wheel '{}' turns at {:.3f} "
          "rad/s",
          *still, wheel, speed);
    }
  }
  return {};
}

std::string RobotPrior::flaw(const MotionPrior& prior) const {
  if (!config_.fixed_base) {
    if (std::string why = odometry_.flaw(prior.utime_a, prior.utime_b); !why.empty()) return why;
    if (std::string why = frozen(prior.utime_a, prior.utime_b); !why.empty()) return why;
  }
  return joints_.flaw(prior.utime_a, prior.utime_b, camera_joints_);
}

std::string RobotPrior::fillCamera(MotionPrior& prior) const {
  const PoseAt base_a = baseAt(prior.utime_a);
  const PoseAt base_b = baseAt(prior.utime_b);
  const Ends joints = jointsAt(prior, camera_joints_);
  Judge judge;
  judge.take(base_b.state, base_b.reason);
  judge.take(joints.b.state, joints.b.reason);
  judge.take(base_a.state, previous(base_a.reason));
  judge.take(joints.a.state, previous(joints.a.reason));
  judge.refuse(flaw(prior));
  prior.camera = judge.state();
  if (prior.camera == PriorState::kMissing) return judge.reason();

  const auto chain = [this](const JointPositions& q) {
    return chainPoseWithNoise(robot_, config_.base_link, config_.camera_link, q, config_);
  };
  const ChainPose T_BC_a = chain(joints.a.q);
  const ChainPose T_BC_b = chain(joints.b.q);
  const SE3 T_BaBb = base_a.pose.inverse() * base_b.pose;
  prior.T_WCb = base_b.pose * T_BC_b.T;
  prior.T_CaCb = prior.utime_a == prior.utime_b ? SE3() : T_BC_a.T.inverse() * T_BaBb * T_BC_b.T;
  prior.camera_cov =
      cameraMotionCovariance(T_BC_a, T_BC_b, prior.T_CaCb,
                             incrementCovariance(config_.base_drift, T_BaBb, secondsOf(prior)));
  return judge.reason();
}

std::string RobotPrior::fillObject(MotionPrior& prior) const {
  if (!hasGripper()) return {};
  prior.object_kind = ObjectPriorKind::kCameraFrame;
  const GraspTimeline::Held grasp = grasps_.between(prior.utime_a, prior.utime_b);
  prior.object = PriorState::kMissing;
  if (!grasp.held) return {};
  const Ends joints = jointsAt(prior, gripper_joints_);
  Judge judge;
  judge.take(joints.b.state, joints.b.reason);
  judge.take(joints.a.state, previous(joints.a.reason));
  judge.refuse(joints_.flaw(prior.utime_a, prior.utime_b, gripper_joints_));
  prior.object = judge.state();
  if (prior.object == PriorState::kMissing) return judge.reason();

  const auto chain = [this](const JointPositions& q) {
    return chainPoseWithNoise(robot_, config_.camera_link, config_.gripper_link, q, config_);
  };
  const ChainPose T_CG_a = chain(joints.a.q);
  const ChainPose T_CG_b = chain(joints.b.q);
  prior.T_XOa = T_CG_a.T * grasp.T_GO;
  prior.T_XOb = T_CG_b.T * grasp.T_GO;
  const SE3 T_OaOb = prior.T_XOa.inverse() * prior.T_XOb;
  prior.object_cov =
      heldMotionCovariance(T_CG_a, T_CG_b, grasp.T_GO,
                           incrementCovariance(config_.grasp_drift, T_OaOb, secondsOf(prior)));
  return judge.reason();
}

void RobotPrior::fillSelf(MotionPrior& prior) const {
  std::map<std::string, std::optional<SE3>> T_CL;
  for (const LinkShape& shape : robot_.collisionShapes()) {
    if (prior.self.size() == kMaxRobotShapes) return;
    auto [link, fresh] = T_CL.try_emplace(shape.link);
    if (fresh) {
      try {
        const auto needed = robot_.jointsBetween(config_.camera_link, shape.link);
        const JointsAt joints = joints_.at(prior.utime_b, needed, max_gap_, max_extrapolation_);
        if (joints.state != PriorState::kMissing)
          link->second = robot_.T_AB(config_.camera_link, shape.link, joints.q);
      } catch (const KinematicsError&) {
        continue;  // behind a floating joint: its place is not known
      }
    }
    if (link->second) prior.self.push_back({shape.kind, shape.half, *link->second * shape.T_LS});
  }
}

std::optional<SE3> RobotPrior::cameraPose(std::int64_t utime) const {
  const PoseAt base = baseAt(utime);
  const JointsAt joints = joints_.at(utime, camera_joints_, max_gap_, max_extrapolation_);
  if (base.state != PriorState::kValid || joints.state != PriorState::kValid) return std::nullopt;
  return base.pose * robot_.T_AB(config_.base_link, config_.camera_link, joints.q);
}

bool RobotPrior::covers(std::int64_t utime) const {
  return (config_.fixed_base || odometry_.covers(utime)) && joints_.covers(utime, camera_joints_) &&
         joints_.covers(utime, gripper_joints_);
}

std::vector<std::string> RobotPrior::complaints() const {
  std::vector<std::string> out;
  if (!config_.fixed_base && odometry_.counts().accepted == 0)
    out.emplace_back("no odometry: camera priors are missing (fixed_base says that there is none)");
  for (const std::string& joint : joints_.unseen()) {
    const auto needs = [&](const std::vector<std::string>& joints) {
      return std::find(joints.begin(), joints.end(), joint) != joints.end();
    };
    std::string effect = "shapes of links behind it are left out";
    if (needs(gripper_joints_)) effect = "object priors are missing";
    if (needs(camera_joints_)) effect = "camera priors are missing";
    if (needs(wheels_)) effect = "frozen odometry is not seen by it";
    out.push_back(fmt::format("joint '{}' has no samples: {}", joint, effect));
  }
  return out;
}

}  // namespace rf
