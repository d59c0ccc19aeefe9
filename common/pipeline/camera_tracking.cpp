// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/camera_tracking.hpp"

#include <utility>
#include <vector>

#include "mapping/tracker.hpp"
#include "pipeline/camera_health.hpp"
#include "pipeline/pose_uncertainty.hpp"
#include "pipeline/wide_search.hpp"

namespace rf {
namespace {

constexpr double kScarceWorld = 0.15;  // share of the image

// Camera motion since the last processed frame, before refinement. Where segmentation's frame A is
// not that frame (loss, restart), increments of one and the same prior bridge the gap, else
// constant velocity.
SE3 stepOf(const SegmentationResult& s, const FusionState& m) {
  if (!m.bridged(s)) return s.camera.T_AB;
  if (s.has_prior_T_WC && m.last_prior) return m.last_prior->inverse() * s.prior_T_WC;
  if (s.first) return SE3::exp(m.velocity * m.secondsSince(s.utime));
  return SE3::exp(m.velocity * m.secondsSince(s.utime_a)) * s.camera.T_AB;
}

// An object at rest is as good a landmark as the world, but it may start to move unnoticed: it only
// helps where the world alone is too little.
std::vector<TrackReference> referenceOf(const FusionState& m) {
  const double pixels = static_cast<double>(m.camera.width * m.camera.height);
  const bool scarce =
      static_cast<double>(stablePixels(m.world.prediction, m.stable)) < kScarceWorld * pixels;
  const bool help = m.life.phase == ObjectPhase::kResting && scarce;
  return makeReference(
      help ? mergeNearest(m.world.prediction, m.object.prediction) : m.world.prediction,
      m.config.tracking.levels, logit(m.config.tracking.full_confidence));
}

// Starts beside the segmentation's, which did not lead to the model: the camera's own velocity, the
// prior's increment, and after more than one such frame a wide search with every pixel (the mask
// may be what is wrong, and the map holds the static world alone).
TrackResult trackElsewhere(const FusionInput& f, const SegmentationResult& s, const SE3& start,
                           const std::vector<TrackReference>& reference, const FusionState& m) {
  const TrackingConfig& t = m.config.tracking;
  const double least = m.minInliers();
  const double enough = kSureFactor * least;
  const Mat6 loose = startCovariance(Mat6::Zero(), t, kGapInflation);
  const WeightPyramid weights = weightPyramid(f.weights.world.own, t.levels);
  std::vector<SE3> starts = {SE3::exp(m.velocity * m.secondsSince(s.utime))};
  if (s.has_prior_T_WC && m.last_prior) starts.push_back(m.last_prior->inverse() * s.prior_T_WC);
  const WeightPyramid all = weightPyramid(everywhere(f.maps.depth), t.levels);
  TrackResult best;
  for (const SE3& other : starts) {
    for (const WeightPyramid* w : {&weights, &all}) {
      TrackResult r = alignToModel(reference, f.pyramid, *w, other, loose, enough, m.config);
      if (believed(r, least, m) && r.inliers > best.inliers) best = std::move(r);
    }
  }
  if (best.accepted || m.rejected_frames == 0) return best;
  starts.push_back(start);
  for (const SE3& other : starts) {
    TrackResult r = alignToModel(reference, f.pyramid, all, other, loose * kSearchInflation, enough,
                                 wideSearch(m.config));
    if (believed(r, least, m) && r.inliers > best.inliers) best = std::move(r);
  }
  return best;
}

void startAt(const SegmentationResult& s, FusionState& m) {
  constexpr double kExact = 1e-12;
  m.T_WF = s.has_prior_T_WC ? s.prior_T_WC : SE3();
  m.world.T_FC = SE3();
  m.camera_pose = {};
  m.camera_pose.T_W = m.T_WF;
  m.camera_pose.covariance = Mat6::Identity() * kExact;
  m.camera_pose.health = Health::kTracked;
}

}  // namespace

bool trackCamera(const FusionInput& f, const SegmentationResult& s, FusionState& m) {
  if (!m.started) {
    startAt(s, m);
    return true;
  }
  const bool gap = m.bridged(s);
  const SE3 start = stepOf(s, m);
  const TrackingConfig& t = m.config.tracking;
  const Mat6 start_cov = startCovariance(s.camera.covariance, t, gap ? kGapInflation : 1.0);
  const std::vector<TrackReference> reference = referenceOf(m);
  TrackResult r = alignToModel(reference, f.pyramid, weightPyramid(f.weights.world.own, t.levels),
                               start, start_cov, m.minInliers(), m.config);
  noteLeap(s, r, m);
  if (r.accepted && !believed(r, m.minInliers(), m)) {
    r.accepted = false;
    r.T_PC = start;
  }
  const TrackResult again = r.accepted ? TrackResult{} : trackElsewhere(f, s, start, reference, m);
  if (again.accepted) r = again;
  // Without a prior and without the model's support a leap is not believed: rather stay in motion.
  const SE3 steady = SE3::exp(m.velocity * m.secondsSince(s.utime));
  const bool leap =
      !r.accepted && !s.has_prior_T_WC && (steady.inverse() * start).t.norm() > t.max_shift_m;
  if (leap) r.T_PC = steady;
  const bool lost = !r.accepted && s.camera.health == Health::kLost;
  if (lost) r.T_PC = SE3();  // neither image nor prior: the last known pose
  m.world.T_FC = m.world.T_FC * r.T_PC;
  m.camera_pose.T_W = m.T_WF * m.world.T_FC;
  const Mat6 step_cov = gap || leap || lost ? start_cov : stepCovariance(s.camera.covariance, t);
  if (r.accepted && m.config.sensor.adapt_noise) {
    m.noise.learn(r.rms_sigma);
    m.config.sensor.noise = m.noise.factor();
  }
  const bool jump = r.accepted && jumps(r.T_PC, steady, m.secondsSince(s.utime));
  judgeCamera({r, s, step_cov, m.minInliers(), gap, leap, jump}, m);
  // A frame that segmentation could not read has no mask; a picture that shows nothing must not
  // repaint the map, nor may a wrong place become one. A pose that has nothing to be compared with
  // may be fused while it is trusted.
  const bool masked = s.first || s.camera.health <= Health::kDegraded;
  if (r.accepted) return masked && !m.blind && !jump;
  return r.inlier_share == 0 && m.camera_pose.health < Health::kPriorOnly &&
         positionSigma(m.camera_pose.covariance) < kTrustedSigma;
}

}  // namespace rf
