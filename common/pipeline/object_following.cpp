// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/object_following.hpp"

#include "mapping/body_model.hpp"
#include "mapping/tracker.hpp"

namespace rf {
namespace {

constexpr double kGapInflation = 100.0;  // ten times the usual standard deviations
constexpr double kFewPixels = 0.3;       // of those that tracking needs

// The object's pose in the world from T_FC; its covariance follows in pose_uncertainty.
void placeObject(FusionState& m) {
  m.T_WO = m.camera_pose.T_W * m.object.T_FC.inverse();
  m.object_pose.T_W = m.T_WO;
}

// Of T_OC after a step with this result: given the model, or the old one and the step's.
Mat6 relativeCovariance(const TrackResult& r, const FusionState& m) {
  if (r.accepted) return r.covariance;
  const Mat6 back = r.T_PC.inverse().adjoint();
  return back * m.covariance_OC * back.transpose() + r.covariance;
}

void giveBirth(const SegmentationResult& s, FusionState& m) {
  m.object = BodyModel(m.config, m.camera);
  m.object.T_FC = s.has_T_CO ? s.T_CO.inverse() : SE3();
  m.T_WO_birth = m.camera_pose.T_W * m.object.T_FC.inverse();
  m.object_pose = {};
  m.object_pose.health = worse(s.object.health, m.camera_pose.health);
  placeObject(m);
}

// Refines the moving object's pose; whether the frame may be fused into its model.
bool trackObject(const FusionInput& f, const SegmentationResult& s, FusionState& m) {
  const TrackingConfig& t = m.config.tracking;
  const bool gap = m.bridged(s);
  const SE3 start =
      gap ? m.object.T_FC.inverse() * m.T_WO.inverse() * m.camera_pose.T_W : s.object.T_AB;
  const Mat6 start_cov = startCovariance(s.object.covariance, t, gap ? kGapInflation : 1.0);
  TrackResult r;
  r.T_PC = start;
  r.covariance = start_cov;
  const bool enough =
      static_cast<double>(stablePixels(m.object.prediction, m.stable)) >= m.minObjectPixels();
  if (enough) {
    r = alignToModel(makeReference(m.object.prediction, t.levels, m.stable), f.pyramid,
                     weightPyramid(f.weights.object.own, t.levels), start, start_cov,
                     kFewPixels * m.minObjectPixels(), m.config);
  }
  m.object.T_FC = m.object.T_FC * r.T_PC;
  m.object_pose.inliers = r.inliers;
  m.object_pose.rms_residual = r.rms_m;
  const bool sure = r.accepted && !gap && !m.blind;
  // A pose in the world is worth no more than the camera's.
  m.object_pose.health = worse(m.camera_pose.health,
                               sure ? Health::kTracked : worse(s.object.health, Health::kDegraded));
  m.object_on_map = r.accepted;
  m.covariance_OC = relativeCovariance(r, m);
  placeObject(m);
  return !m.blind && (r.accepted || !enough || r.inlier_share == 0);
}

}  // namespace

bool followObject(const FusionInput& f, const SegmentationResult& s, ObjectAction action,
                  FusionState& m) {
  switch (action) {
    case ObjectAction::kForget:
      m.object = BodyModel(m.config, m.camera);
      m.object_pose = {};
      m.object_pose.health = Health::kLost;
      return false;
    case ObjectAction::kNothing:
      m.object_pose.health = Health::kLost;
      return false;
    case ObjectAction::kRest:
      m.object.T_FC = m.T_WO.inverse() * m.camera_pose.T_W;
      return false;
    case ObjectAction::kBirth:
      giveBirth(s, m);
      return true;
    case ObjectAction::kMove:
      break;
  }
  return trackObject(f, s, m);
}

void judgeRestingObject(const FusionInput& f, FusionState& m) {
  constexpr double kConfirmed = 0.5;
  constexpr double kRefuted = 0.2;
  const Agreement a = agreement(m.object.prediction, f.maps, m.config);
  const double seen = a.on_surface + a.through;
  m.object_pose.inliers = a.on_surface;
  m.object_pose.rms_residual = 0;
  if (seen < kFewPixels * m.minObjectPixels()) {
    m.object_pose.health = Health::kPriorOnly;
  } else if (a.on_surface > kConfirmed * seen) {
    m.object_pose.health = worse(Health::kTracked, m.camera_pose.health);
  } else {
    m.object_pose.health = a.on_surface > kRefuted * seen ? Health::kDegraded : Health::kLost;
  }
}

}  // namespace rf
