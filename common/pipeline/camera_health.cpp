// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/camera_health.hpp"

#include <algorithm>

#include "pipeline/pose_uncertainty.hpp"
#include "pipeline/wide_search.hpp"

namespace rf {
namespace {

// A picture of the place correlates with the map's, whatever the light (0.95 and more); one of
// another place does not (below 0). Half of the range between.
constexpr double kLeastLikeness = 0.5;

// A place that the map contradicted before is found again when this much of the support that was
// usual fits: a patch of some other wall also fits, with a seventh (a teleport in the tests).
constexpr double kLeastSupport = 0.25;

// ... and no worse than a frame that is tracked usually does: the whitened residual within a half
// of it, the difference of the pictures within three times. The wrong wall of a teleport had 1.7 to
// 2 times the residual and 15 to 40 times the difference, before it was fused and grew to look
// right.
constexpr double kUsualFit = 1.5;
constexpr double kUsualUnlikeness = 3.0;
constexpr double kLeastUnlikeness = 0.02;  // other light, other noise

bool fitsAsUsual(const TrackResult& r, const FusionState& m) {
  if (!(m.usual_fit > 0)) return true;
  return r.rms_sigma <= kUsualFit * m.usual_fit &&
         1 - r.likeness <= kUsualUnlikeness * m.usual_unlikeness + kLeastUnlikeness;
}

void learnFit(const TrackResult& r, FusionState& m) {
  constexpr double kMemory = 0.1;  // ten frames
  const double share = m.usual_fit > 0 ? kMemory : 1.0;
  m.usual_fit += share * (r.rms_sigma - m.usual_fit);
  m.usual_unlikeness += share * (1 - r.likeness - m.usual_unlikeness);
}

// Surface is in view where the map has some, and it does not fit: the pose is wrong. It lies
// outside the range that was searched, or it would have been found.
bool contradicted(const CameraEvidence& e) { return e.track.pairs >= kSureFactor * e.min_inliers; }

// The range in which the map was looked for, and in a second frame in vain the wider one.
Mat6 searchedRange(const TrackingConfig& t, bool wide) {
  const double shift = t.max_shift_m * (wide ? kWideShift : 1.0);
  const double turn = t.max_turn_rad * (wide ? kWideTurn : 1.0);
  Mat6 out = Mat6::Zero();
  out.diagonal().head<3>().setConstant(shift * shift);
  out.diagonal().tail<3>().setConstant(turn * turn);
  return out;
}

// More than half of the map in view was taken away by the mask from one frame to the next: an
// object appears, or mask and world were swapped. True until that has become usual, in a few
// frames.
bool supportLost(double pairs, FusionState& m) {
  constexpr double kHalf = 0.5;
  constexpr double kMemory = 0.2;  // about five frames
  const bool lost = pairs < kHalf * m.usual_pairs;
  m.usual_pairs = m.usual_pairs > 0 ? m.usual_pairs + kMemory * (pairs - m.usual_pairs) : pairs;
  return lost;
}

void judgeAligned(const CameraEvidence& e, FusionState& m) {
  m.camera_pose.covariance = e.track.covariance;
  m.blind = e.track.blind;
  const bool sudden = supportLost(e.track.pairs, m);
  if (!m.blind) learnFit(e.track, m);
  const bool weak =
      e.gap || e.jump || m.blind || sudden || e.track.inliers < kSureFactor * e.min_inliers;
  m.camera_pose.health = weak ? Health::kDegraded : Health::kTracked;
}

void judgeUnaligned(const CameraEvidence& e, FusionState& m) {
  BodyPose& pose = m.camera_pose;
  const Mat6 back = e.track.T_PC.inverse().adjoint();
  pose.covariance = back * pose.covariance * back.transpose() + e.step_covariance;
  if (contradicted(e) && ++m.contradicted_frames <= 2) {
    pose.covariance += searchedRange(m.config.tracking, m.contradicted_frames == 2);
  }
  pose.health = worse(worse(e.segmentation.camera.health, Health::kDegraded),
                      e.gap ? Health::kPriorOnly : Health::kDegraded);
  if (e.leap) pose.health = Health::kLost;
}

}  // namespace

bool believed(const TrackResult& r, double min_inliers, const FusionState& m) {
  if (!r.accepted || r.likeness < kLeastLikeness) return false;
  if (positionSigma(m.camera_pose.covariance) < kTrustedSigma) return true;
  const double least = std::max(kSureFactor * min_inliers, kLeastSupport * m.usual_pairs);
  return r.inliers >= least && r.inlier_share >= m.config.tracking.sure_share && !r.blind &&
         fitsAsUsual(r, m);
}

bool jumps(const SE3& step, const SE3& steady, double seconds) {
  constexpr double kShift = 0.1;          // metres: what health promises
  constexpr double kAcceleration = 20.0;  // m/s^2
  const double shift = (steady.inverse() * step).t.norm();
  return shift > std::max(kShift, kAcceleration * seconds * seconds);
}

void noteLeap(const SegmentationResult& s, const TrackResult& r, FusionState& m) {
  const double residual = s.camera.rms_residual;
  if (m.usual_residual.exceededBy(residual) && !r.blind) {
    const Mat6 range = searchedRange(m.config.tracking, false);
    m.camera_pose.covariance += range;
    m.covariance_OC += range;
    m.object_found = false;
  }
  m.usual_residual.learn(residual);
}

void judgeCamera(const CameraEvidence& e, FusionState& m) {
  m.camera_pose.inliers = e.track.inliers;
  m.camera_pose.rms_residual = e.track.rms_m;
  m.camera_on_map = e.track.accepted;
  m.blind = false;
  m.rejected_frames = e.track.accepted ? 0 : m.rejected_frames + 1;
  if (e.track.accepted) m.contradicted_frames = 0;
  if (e.track.accepted) {
    judgeAligned(e, m);
  } else {
    judgeUnaligned(e, m);
  }
}

}  // namespace rf
