// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/prior_intake.hpp"

#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

namespace rf {
namespace {

Mat6 inverseOf(const Mat6& covariance) {
  const Mat6 regular = covariance + 1e-12 * Mat6::Identity();
  return regular.ldlt().solve(Mat6::Identity());
}

/// Whether a camera may see a body there: what a start pose is checked by when nothing else can.
bool inView(const Vec3& t_CO) {
  constexpr double kFarthest = 8.0;  // metres, beyond any structured-light sensor
  constexpr double kWidest = 1.5;    // tangent, beyond any such camera's half angle
  return t_CO.z() > 0.1 && t_CO.z() < kFarthest && t_CO.head<2>().norm() < kWidest * t_CO.z();
}

}  // namespace

PriorIntake::ObjectUse PriorIntake::useOf(const SegmentationConfig& config) {
  const std::string& name = config.object_prior_use;
  if (name == "all") return ObjectUse::kAll;
  if (name == "start") return ObjectUse::kStart;
  if (name == "none") return ObjectUse::kNone;
  throw std::invalid_argument("segmentation.object_prior_use = " + name +
                              ": must be all, start or none");
}

PriorIntake::PriorIntake(const SegmentationConfig& config)
    : config_(config),
      object_use_(useOf(config)),
      camera_filter_({config.camera_spread_m, config.camera_spread_rad}),
      object_filter_({config.object_spread_m, config.object_spread_rad}),
      camera_trust_(config.prior_trust),
      object_trust_(config.prior_trust),
      rest_trust_(config.prior_trust, PriorTrust::Start::kNothing),
      object_anchored_(object_use_ != ObjectUse::kNone) {}

bool PriorIntake::learnCameraStep(const PastFrame& before, PastFrame& now) const {
  if (!before.camera_confirmed || !now.camera_confirmed || now.camera.measured) return false;
  now.camera.T = before.T_WC.inverse() * now.T_WC;
  now.camera.covariance = covarianceOf({config_.estimate_spread_m, config_.estimate_spread_rad});
  return true;
}

bool PriorIntake::learnObjectStep(const PastFrame& before, PastFrame& now) const {
  const bool confirmed = before.object_confirmed && now.object_confirmed;
  if (!confirmed || now.object.measured || !object_seen_) return false;
  const SE3 T_WO_before = before.T_WC * before.T_CO;
  now.object.T = kinematic_object_ ? before.T_CO * now.T_CO.inverse()
                                   : T_WO_before.inverse() * now.T_WC * now.T_CO;
  now.object.covariance = covarianceOf({config_.estimate_spread_m, config_.estimate_spread_rad});
  return true;
}

void PriorIntake::judge(const PastFrame& p, const PastFrame* before) {
  if (p.camera_source.measured && p.object_confirmed && p.object_moves && !mature()) {
    const bool contradicts = rightAtRest() && camera_trust_.translationFactor() > 1.0;
    agreed_frames_ = contradicts ? 0 : agreed_frames_ + 1;
  }
  const bool follows = before != nullptr && before->camera_confirmed;
  camera_trust_.observe(p.camera_source, p.T_WC, follows);
  // Of two motions the wrong one must not talk down the only witness against it.
  if (!p.object_moves) {
    rest_trust_.observe(p.camera_source, p.T_WC, follows && !before->object_moves);
  }
  if (!p.object_confirmed || !object_seen_) return;
  const SE3 pose = kinematic_object_ ? p.T_CO.inverse() : p.T_WC * p.T_CO;
  object_trust_.observe(p.object_source, pose, before != nullptr && before->object_confirmed);
}

void PriorIntake::start(const MotionPrior& prior, PastFrame& now) {
  if (prior.camera != PriorState::kMissing) now.T_WC = prior.T_WCb;
  if (prior.object == PriorState::kMissing || !object_anchored_) return;
  if (prior.object_kind == ObjectPriorKind::kCameraFrame) {
    now.T_CO = prior.T_XOb;
  } else if (prior.object_kind == ObjectPriorKind::kWorldFrame) {
    now.T_CO = now.T_WC.inverse() * prior.T_XOb;  // both sources as given, before any drift
    // Without a camera pose the object's world may be any: its directions would be noise.
    object_anchored_ = prior.camera != PriorState::kMissing || inView(now.T_CO.t);
  }
  object_seen_ = object_anchored_;
}

void PriorIntake::accept(const MotionPrior& prior, const LastMotion& last, PastFrame& now) {
  std::optional<SE3> camera_prior;
  if (prior.camera != PriorState::kMissing) {
    camera_prior = prior.T_CaCb;
    now.camera_source = {prior.T_CaCb, prior.camera_cov, true, false};
  }
  const PriorTrust& trust = object_seen_ || mature() ? camera_trust_ : rest_trust_;
  now.camera = camera_filter_.accept(camera_prior, trust.adapted(prior.camera_cov), last.camera);
  std::optional<SE3> object_prior;
  if (object_anchored_ && prior.object != PriorState::kMissing &&
      prior.object_kind != ObjectPriorKind::kNone) {
    kinematic_object_ = prior.object_kind == ObjectPriorKind::kCameraFrame;
    const SE3 given = kinematic_object_ ? prior.T_XOa * prior.T_XOb.inverse()
                                        : prior.T_XOa.inverse() * prior.T_XOb;
    object_seen_ = true;
    now.object_source = {given, prior.object_cov, true, false};
    if (object_use_ == ObjectUse::kAll || !mature()) object_prior = given;
  }
  now.object = object_filter_.accept(object_prior, object_trust_.adapted(prior.object_cov),
                                     kinematic_object_ ? last.object_motion : last.object);
}

Increment PriorIntake::unmeasured(const std::optional<SE3>& last_motion) const {
  return PriorFilter({config_.camera_spread_m, config_.camera_spread_rad})
      .accept(std::nullopt, Mat6::Zero(), last_motion);
}

JointPrior PriorIntake::make(const SE3& T_s, const Mat6& cov_s, const PastFrame& at,
                             const Increment& object) const {
  JointPrior out;
  out.T_s = T_s;
  out.information_s = inverseOf(cov_s);
  out.object = JointPrior::Object::kRelative;
  if (!object_seen_) {
    // No object prior at all: what the body did last, loosely; the outlier rule seeds the mask.
    out.outlier_class = true;
    out.object_motion = SE3();
    Mat6 loose = covarianceOf({config_.free_object_m, config_.free_object_rad});
    out.information_d = inverseOf(loose);
    return out;
  }
  if (kinematic_object_) {
    out.object = JointPrior::Object::kAbsolute;
    out.object_motion = object.T;
    out.information_d = inverseOf(object.covariance);
    return out;
  }
  out.object_motion = at.T_CO * object.T.inverse() * at.T_CO.inverse();
  const Mat6 A = at.T_CO.inverse().adjoint();
  out.information_d = A.transpose() * inverseOf(object.covariance) * A;
  return out;
}

JointPrior PriorIntake::window(const std::deque<PastFrame>& past, const PastFrame& ref,
                               const PastFrame& now) const {
  Increment camera_sum{SE3(), Mat6::Zero(), true, false};
  Increment object_sum = camera_sum;
  const auto add = [&](const PastFrame& p) {
    camera_sum = compose(camera_sum, p.camera);
    object_sum = compose(object_sum, p.object);
  };
  for (const PastFrame& p : past) {
    if (p.utime > ref.utime) add(p);
  }
  add(now);
  return make(camera_sum.T, camera_sum.covariance, ref, object_sum);
}

JointPrior PriorIntake::step(const PastFrame& ref, const PastFrame& last,
                             const PastFrame& now) const {
  const SE3 chain_s = ref.T_WC.inverse() * last.T_WC;
  Increment object = now.object;
  Mat6 camera_covariance = now.camera.covariance;
  if (!ref.anchored || !last.anchored) {
    const Mat6 chain = covarianceOf({config_.chain_spread_m, config_.chain_spread_rad});
    camera_covariance += chain;
    object.covariance += chain;
  }
  JointPrior step = make(chain_s * now.camera.T, camera_covariance, last, object);
  const SE3 chain_d = ref.T_CO * last.T_CO.inverse();
  step.object_motion = step.object == JointPrior::Object::kAbsolute
                           ? chain_d * step.object_motion
                           : chain_d * step.object_motion * chain_s.inverse();
  return step;
}

}  // namespace rf
