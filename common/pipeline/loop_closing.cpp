// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/loop_closing.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>

#include "mapping/map_correction.hpp"
#include "mapping/map_uncertainty.hpp"
#include "mapping/tracker.hpp"

namespace rf {
namespace {

constexpr double kStartInflation = 100.0;  // each pose is found by its own surface
constexpr int kEvery = 4;                  // frames: surface that comes back stays for longer

std::size_t epochAt(const BodyModel& world, std::uint32_t id) {
  const SurfelBlock& block = world.map.block(static_cast<int>(id / kBlockSize));
  return MapUncertainty::epochOf(block.born[id % kBlockSize]);
}

// The part of the prediction that came back into view, or the other.
Prediction partOf(const BodyModel& world, bool came_back) {
  Prediction part = world.prediction;
  for (std::size_t i = 0; i < part.depth.size(); ++i) {
    if (part.id[i] == kNoSurfel) continue;
    if (world.uncertainty.cameBack(epochAt(world, part.id[i])) == came_back) continue;
    part.id[i] = kNoSurfel;
    part.depth[i] = 0;
  }
  return part;
}

std::int64_t seenPixels(const Prediction& p) {
  return std::count_if(p.depth.begin(), p.depth.end(), [](float z) { return z > 0; });
}

// A camera by one part of the map alone, and its covariance (left, frame F).
struct PartPose {
  SE3 T_FC;
  Mat6 covariance_F;
};

std::optional<PartPose> alignToPart(const FusionInput& f, const Prediction& part,
                                    const FusionState& m) {
  const TrackingConfig& t = m.config.tracking;
  const double least = m.config.loop.min_share * static_cast<double>(part.depth.size());
  if (static_cast<double>(seenPixels(part)) < least) return std::nullopt;
  const TrackResult r = alignToModel(makeReference(part, t.levels, m.stable), f.pyramid,
                                     weightPyramid(f.weights.world.own, t.levels), SE3(),
                                     startCovariance(Mat6::Zero(), t, kStartInflation),
                                     t.min_inlier_share * least, m.config);
  if (!r.accepted) return std::nullopt;
  const SE3 T_FC = m.world.T_FC * r.T_PC;
  return PartPose{T_FC, toLeft(T_FC, r.covariance)};
}

// So much of a camera motion that it stays within the step.
double shareOf(const Vec6& motion_C, const LoopConfig& c) {
  const double steps =
      std::max(motion_C.head<3>().norm() / c.step_m, motion_C.tail<3>().norm() / c.step_rad);
  return steps > 1.0 ? 1.0 / steps : 1.0;
}

void moveState(const SE3& move_F, FusionState& m) {
  m.world.T_FC = move_F * m.world.T_FC;
  m.camera_pose.T_W = m.T_WF * m.world.T_FC;
  m.T_WO = m.T_WF * move_F * m.T_WF.inverse() * m.T_WO;
  m.object_pose.T_W = m.T_WO;
}

/// What lies between the camera by the part that came back and by the younger one.
struct Drift {
  Vec6 twist_F;       ///< left perturbation
  Mat6 expected_F;    ///< covariance of the younger part, by the map's own account
  Mat6 innovation_F;  ///< that and the noise of the two alignments
};

std::optional<Drift> observedDrift(const FusionInput& f, const FusionState& m) {
  const LoopConfig& c = m.config.loop;
  const auto by_old = alignToPart(f, partOf(m.world, true), m);
  if (!by_old) return std::nullopt;
  const Prediction young = partOf(m.world, false);
  const auto by_young = alignToPart(f, young, m);
  if (!by_young) return std::nullopt;
  const Mat6 noise_F = by_old->covariance_F + by_young->covariance_F;
  Drift d;
  d.twist_F = (by_old->T_FC * by_young->T_FC.inverse()).log();
  if (d.twist_F.dot(noise_F.ldlt().solve(d.twist_F)) < c.significance) return std::nullopt;
  d.expected_F =
      m.world.uncertainty.of(m.world.uncertainty.seen(m.world.map, young, f.weights.world.own));
  d.innovation_F = d.expected_F + noise_F;
  if (d.twist_F.dot(d.innovation_F.ldlt().solve(d.twist_F)) > c.plausible) return std::nullopt;
  return d;
}

}  // namespace

bool closeLoop(const FusionInput& f, FusionState& m) {
  const LoopConfig& c = m.config.loop;
  if (!c.close || !m.camera_on_map) return false;
  if (m.drift_frames == 0 && m.time % kEvery != 0) return false;
  const std::optional<Drift> drift = observedDrift(f, m);
  m.drift_frames = drift ? m.drift_frames + 1 : 0;
  if (!drift || m.drift_frames < c.confirm_frames) return false;

  const Mat6& S = drift->innovation_F;
  const Vec6 camera_F = drift->expected_F * S.ldlt().solve(drift->twist_F);
  const double share = shareOf(m.world.T_FC.inverse().adjoint() * camera_F, c);
  std::vector<Vec6> twists;
  for (const Mat6& gain : m.world.uncertainty.takeCorrection(S, share)) {
    twists.emplace_back(share * gain * drift->twist_F);
  }
  moveByBirth(twists, m.world.map);
  moveState(SE3::exp(share * camera_F), m);
  m.world.predictor.predict(m.world.map, m.world.T_FC, m.camera, PredictOptions::from(m.config),
                            m.world.prediction);
  return share < 1.0;
}

}  // namespace rf
