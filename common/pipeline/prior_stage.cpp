// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/prior_stage.hpp"

#include <stdexcept>
#include <tuple>
#include <utility>

namespace rf {
namespace {

ObjectPriorKind kindOf(const std::string& object_frame) {
  if (object_frame == "world") return ObjectPriorKind::kWorldFrame;
  if (object_frame == "camera") return ObjectPriorKind::kCameraFrame;
  throw std::invalid_argument("prior.object_frame = " + object_frame + ": must be world or camera");
}

double secondsOf(const MotionPrior& prior) {
  return 1e-6 * static_cast<double>(prior.utime_b - prior.utime_a);
}

/// The state of a pair and, when it is not valid, why.
std::pair<PriorState, std::string> judge(const PoseAt& a, const PoseAt& b) {
  for (const PriorState worst : {PriorState::kMissing, PriorState::kExtrapolated}) {
    if (b.state == worst) return {worst, b.reason};
    if (a.state == worst) return {worst, "previous frame: " + a.reason};
  }
  return {PriorState::kValid, {}};
}

void count(PriorState state, std::int64_t& missing, std::int64_t& extrapolated) {
  missing += state == PriorState::kMissing;
  extrapolated += state == PriorState::kExtrapolated;
}

Mat6 moved(const SE3& T, const Mat6& covariance) {
  const Mat6 ad = T.adjoint();
  return ad * covariance * ad.transpose();
}

}  // namespace

PriorStage::PriorStage(const PriorConfig& config)
    : config_(config),
      T_BC_(toTransform(config.base_to_camera, "prior.base_to_camera")),
      object_kind_(kindOf(config.object_frame)) {}

PoseVerdict PriorStage::addCameraPose(std::int64_t utime, const SE3& T_WB) {
  has_camera_ = true;
  return camera_.add(utime, T_WB);
}

PoseVerdict PriorStage::addObjectPose(std::int64_t utime, const SE3& T_XO) {
  has_object_ = true;
  return object_.add(utime, T_XO);
}

void PriorStage::addCameraPoses(const Trajectory& T_WB) {
  camera_.reserve(camera_.size() + T_WB.size());
  has_camera_ = true;
  for (const StampedPose& p : T_WB) camera_.add(p.utime, p.pose);
}

void PriorStage::addObjectPoses(const Trajectory& T_XO) {
  object_.reserve(object_.size() + T_XO.size());
  has_object_ = true;
  for (const StampedPose& p : T_XO) object_.add(p.utime, p.pose);
}

void PriorStage::useRobot(RobotPrior robot, bool gives_camera, bool gives_object) {
  robot_.emplace(std::move(robot));
  robot_gives_camera_ = gives_camera;
  robot_gives_object_ = gives_object;
}

bool PriorStage::covers(std::int64_t utime) const {
  const auto reaches = [utime](bool exists, const PoseBuffer& buffer) {
    return !exists || (!buffer.empty() && buffer.newest() >= utime);
  };
  return reaches(has_camera_, camera_) && reaches(has_object_, object_) &&
         (!robot_ || robot_->covers(utime));
}

MotionPrior PriorStage::process(std::int64_t utime, std::int64_t seq) {
  if (last_utime_ && utime <= *last_utime_) {
    throw std::invalid_argument("prior: utime = " + std::to_string(utime) +
                                ": must be later than " + std::to_string(*last_utime_));
  }
  MotionPrior prior;
  prior.utime_a = last_utime_.value_or(utime);
  prior.utime_b = utime;
  prior.seq = seq;
  if (has_camera_) fillCamera(prior);
  if (has_object_) fillObject(prior);
  if (robot_) fillFromRobot(prior);
  last_utime_ = utime;
  return prior;
}

PoseAt PriorStage::lookUp(const PoseBuffer& buffer, std::int64_t utime) const {
  return buffer.at(utime, config_.max_gap, config_.max_extrapolation);
}

void PriorStage::fillFromRobot(MotionPrior& prior) {
  if (robot_gives_camera_ && !has_camera_) {
    status_.camera_reason = robot_->fillCamera(prior);
    count(prior.camera, status_.camera_missing, status_.camera_extrapolated);
  }
  if (robot_gives_object_ && !has_object_ && robot_->hasGripper()) {
    status_.object_reason = robot_->fillObject(prior);
    if (!status_.object_reason.empty())
      count(prior.object, status_.object_missing, status_.object_extrapolated);
  }
  robot_->fillSelf(prior);
}

void PriorStage::fillCamera(MotionPrior& prior) {
  const PoseAt a = lookUp(camera_, prior.utime_a);
  const PoseAt b = lookUp(camera_, prior.utime_b);
  std::tie(prior.camera, status_.camera_reason) = judge(a, b);
  count(prior.camera, status_.camera_missing, status_.camera_extrapolated);
  if (prior.camera == PriorState::kMissing) return;
  const SE3 T_BaBb = a.pose.inverse() * b.pose;
  const SE3 T_CB = T_BC_.inverse();
  prior.T_WCb = b.pose * T_BC_;
  prior.T_CaCb = prior.utime_a == prior.utime_b ? SE3() : T_CB * T_BaBb * T_BC_;
  // T_CB d exp(e) T_BC = (T_CB d T_BC) exp(Ad(T_CB) e)
  prior.camera_cov = moved(T_CB, incrementCovariance(config_.camera, T_BaBb, secondsOf(prior)));
}

void PriorStage::fillObject(MotionPrior& prior) {
  prior.object_kind = object_kind_;
  const PoseAt a = lookUp(object_, prior.utime_a);
  const PoseAt b = lookUp(object_, prior.utime_b);
  std::tie(prior.object, status_.object_reason) = judge(a, b);
  count(prior.object, status_.object_missing, status_.object_extrapolated);
  if (prior.object == PriorState::kMissing) return;
  prior.T_XOa = a.pose;
  prior.T_XOb = b.pose;
  const SE3 T_OaOb = a.pose.inverse() * b.pose;
  prior.object_cov = incrementCovariance(config_.object, T_OaOb, secondsOf(prior));
  if (object_kind_ == ObjectPriorKind::kCameraFrame) {
    // T_COa (T_COa d exp(e))^-1 = (T_COa T_COb^-1) exp(-Ad(T_COb) e)
    prior.object_cov = moved(b.pose, prior.object_cov);
  }
}

}  // namespace rf
