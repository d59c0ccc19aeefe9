// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/pose_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Eigenvalues>

#include "mapping/map_uncertainty.hpp"

namespace rf {
namespace {

constexpr double kExact = 1e-12;  // what defines a frame, kept regular

// Pixels whose depth lies near the prediction: those that alignment could use.
Image<float> comparable(const Image<float>& own, const Image<float>& depth,
                        const Prediction& prediction, double distance) {
  Image<float> out(own.width(), own.height());
  const auto limit = static_cast<float>(distance);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool pair =
        depth[i] > 0 && prediction.depth[i] > 0 && std::abs(depth[i] - prediction.depth[i]) < limit;
    out[i] = pair ? own[i] : 0.0F;
  }
  return out;
}

std::vector<MapUncertainty::Share> seenOf(const BodyModel& body, const Image<float>& own,
                                          const FusionInput& f, const FusionConfig& config) {
  return body.uncertainty.seen(
      body.map, body.prediction,
      comparable(own, f.maps.depth, body.prediction, config.tracking.distance_m));
}

void settleCamera(const FusionInput& f, bool fused, FusionState& m) {
  const auto seen = seenOf(m.world, f.weights.world.own, f, m.config);
  Mat6& covariance = m.camera_pose.covariance;
  if (m.camera_on_map) covariance += toRight(m.world.T_FC, m.world.uncertainty.of(seen));
  if (fused) m.world.uncertainty.fuse(m.time, seen, toLeft(m.world.T_FC, covariance));
}

void settleObject(const FusionInput& f, ObjectAction action, bool fused, FusionState& m) {
  std::vector<MapUncertainty::Share> seen;
  if (action == ObjectAction::kBirth) {
    m.covariance_OC = Mat6::Identity() * kExact;
  } else {
    seen = seenOf(m.object, f.weights.object.own, f, m.config);
    if (m.object_on_map) m.covariance_OC += toRight(m.object.T_FC, m.object.uncertainty.of(seen));
  }
  if (fused) m.object.uncertainty.fuse(m.time, seen, toLeft(m.object.T_FC, m.covariance_OC));
  m.object_pose.covariance = toLeft(m.object.T_FC, m.covariance_OC + m.camera_pose.covariance);
}

// A pose that is held constant: as certain as before while the image shows the object there, less
// with every frame that does not.
void settleResting(const SegmentationResult& s, FusionState& m) {
  Mat6& covariance = m.object_pose.covariance;
  if (m.object_pose.health >= Health::kPriorOnly) {
    covariance += toLeft(m.object.T_FC, stepCovariance(s.object.covariance, m.config.tracking));
  }
  m.covariance_OC = toRight(m.object.T_FC, covariance);
}

}  // namespace

double positionSigma(const Mat6& covariance) {
  const Mat3 position = covariance.topLeftCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(position, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues().maxCoeff()));
}

void demoteUncertain(BodyPose& pose) {
  const bool uncertain = !(positionSigma(pose.covariance) < kTrustedSigma);
  if (pose.health == Health::kTracked && uncertain) pose.health = Health::kDegraded;
}

void settleUncertainty(const FusionInput& f, const SegmentationResult& s, ObjectAction action,
                       MayFuse may, FusionState& m) {
  settleCamera(f, may.world, m);
  demoteUncertain(m.camera_pose);
  const bool moved = action == ObjectAction::kBirth || action == ObjectAction::kMove ||
                     action == ObjectAction::kCoast;
  if (moved) settleObject(f, action, may.object, m);
  if (action == ObjectAction::kRest) settleResting(s, m);
  if (m.life.phase != ObjectPhase::kNone) demoteUncertain(m.object_pose);
}

}  // namespace rf
