// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/swapped_reading.hpp"

#include <utility>

#include "pipeline/pose_uncertainty.hpp"

namespace rf {
namespace {

/// The paper's drift adds up alike for about a second (priors/drift.hpp); a longer window tells no
/// more of it and tells it later (docs/RESULTS.md, "Mask and world swapped").
constexpr std::int64_t kWindowUs = 1'000'000;

/// How much more of the squared distance to the prior the other reading has to leave. With errors
/// of unknown size, normal in three directions, that is odds of 3^(3/2) = 5 to 1.
constexpr double kClearly = 3.0;

/// Of our own motions over that time, metres and radians: misfits below it tell nothing.
constexpr double kNoise = 1e-3;

// Of a pose and what the other reading makes of it: of translation and of rotation.
Eigen::Vector2d squaredDistance(const SE3& T_W, const SE3& T_WW) {
  const Vec6 d = (T_W.inverse() * T_WW * T_W).log();
  return {d.head<3>().squaredNorm(), d.tail<3>().squaredNorm()};
}

}  // namespace

void SwappedReading::observe(const SegmentationResult& s, const ReadFrame& frame) {
  doubt_.observe(s);
  Step step{s.utime, frame.T_WC, std::nullopt, SE3(), true};
  if (s.has_prior_T_WC) step.prior_T_WC = s.prior_T_WC;
  if (!frame.born && last_T_WO_ && frame.T_WO) step.body = *last_T_WO_ * frame.T_WO->inverse();
  last_T_WO_ = frame.T_WO;
  // With a prior it is the body's size that raises the doubt; without, the order of both may be
  // any, and all that the body has moved since its birth is in doubt.
  step.in_doubt = !s.has_prior_T_WC || doubt_.possible();
  window_.push_back(std::move(step));
  while (window_.size() > 2 && s.utime - window_[1].utime >= kWindowUs) {
    window_.pop_front();
    if (!window_.front().in_doubt) continue;
    left_window_ = left_window_ * window_.front().body;
    reach_ = reach_.cwiseMax(squaredDistance(frame.T_WC, left_window_));
  }
  if (!priorConfirms()) return;
  for (std::size_t i = 1; i < window_.size(); ++i) window_[i].in_doubt = false;
}

void SwappedReading::turn(const SE3& T_WW, const SE3& T_WO) {
  SE3 at = T_WW;
  for (auto step = window_.rbegin(); step != window_.rend(); ++step) {
    const SE3 before = at * step->body.inverse();
    step->T_WC = at * step->T_WC;
    step->body = before * at.inverse();
    at = before;
  }
  left_window_ = left_window_.inverse();
  last_T_WO_ = T_WO;
}

bool SwappedReading::priorConfirms() const {
  const Step& a = window_.front();
  const Step& b = window_.back();
  if (!a.prior_T_WC || !b.prior_T_WC || b.utime - a.utime < kWindowUs) return false;
  SE3 body;
  for (std::size_t i = 1; i < window_.size(); ++i) body = body * window_[i].body;
  const SE3 prior = (a.prior_T_WC->inverse() * *b.prior_T_WC).inverse();
  const Vec6 ours = (prior * a.T_WC.inverse() * b.T_WC).log();
  const Vec6 other = (prior * a.T_WC.inverse() * body * b.T_WC).log();
  const auto misfit = [](const Vec6& d) {
    return (d.head<3>().squaredNorm() + kNoise * kNoise) *
           (d.tail<3>().squaredNorm() + kNoise * kNoise);
  };
  return kClearly * misfit(ours) < misfit(other);
}

SE3 SwappedReading::distance() const {
  SE3 T_WW = left_window_;
  for (std::size_t i = 1; i < window_.size(); ++i) {
    if (window_[i].in_doubt) T_WW = T_WW * window_[i].body;
  }
  return T_WW;
}

BodyPose SwappedReading::widened(BodyPose pose) const {
  if (!doubt_.possible()) return pose;
  const Eigen::Vector2d d2 = reach_.cwiseMax(squaredDistance(pose.T_W, distance()));
  pose.covariance.diagonal().head<3>().array() += d2[0];
  pose.covariance.diagonal().tail<3>().array() += d2[1];
  demoteUncertain(pose);
  return pose;
}

}  // namespace rf
