// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/object_following.hpp"

#include <cstdint>
#include <vector>

#include "mapping/body_model.hpp"
#include "mapping/tracker.hpp"
#include "pipeline/camera_health.hpp"
#include "pipeline/wide_search.hpp"

namespace rf {
namespace {

constexpr std::size_t kMostPlaces = 32;  // of rest that are remembered
constexpr double kLeaving = 0.1;         // metres: nearer, a wrong label still finds the old place
constexpr double kTurned = 0.05;         // radians: 2 cm at the side of a body of 0.8 m
constexpr double kSmallModel = 2.0;      // surfels by pixels that tracking needs
constexpr int kMostMisfits = 30;         // frames
constexpr double kFewPixels = 0.3;       // of those that tracking needs

// The object's pose in the world from T_FC; its covariance follows in pose_uncertainty.
void placeObject(FusionState& m) {
  m.T_WO = m.camera_pose.T_W * m.object.T_FC.inverse();
  m.object_pose.T_W = m.T_WO;
}

// Of T_OC after a step with this result: given the model, or the old one and the step's.
Mat6 relativeCovariance(const TrackResult& r, const Mat6& step_cov, const FusionState& m) {
  if (r.accepted) return r.covariance;
  const Mat6 back = r.T_PC.inverse().adjoint();
  return back * m.covariance_OC * back.transpose() + step_cov;
}

void giveBirth(const SegmentationResult& s, FusionState& m) {
  m.object = BodyModel(m.config, m.camera);
  m.object.T_FC = s.has_T_CO ? s.T_CO.inverse() : SE3();
  m.T_WO_birth = m.camera_pose.T_W * m.object.T_FC.inverse();
  m.birth_time = m.time;
  m.object_found = true;
  m.object_pose = {};
  m.object_pose.health = worse(s.object.health, m.camera_pose.health);
  placeObject(m);
}

void dropObject(FusionState& m) {
  m.object = BodyModel(m.config, m.camera);
  m.places.clear();
  m.object_pose = {};
  m.object_pose.health = Health::kLost;
}

// The camera in the last frame's, as a point of a resting object has it.
SE3 restingStep(const FusionState& m) {
  return m.object.T_FC.inverse() * m.T_WO.inverse() * m.camera_pose.T_W;
}

// The same of an object that moves on as it did in the last frame that showed it on its model.
SE3 steadyStep(double seconds, const FusionState& m) {
  const SE3 back = SE3::exp(-seconds * m.object_velocity);
  return m.object.T_FC.inverse() * back * m.object.T_FC * restingStep(m);
}

bool enoughInView(const FusionState& m) {
  return static_cast<double>(stablePixels(m.object.prediction, m.stable)) >= m.minObjectPixels();
}

// Aligns the object's model from several starts; the accepted result with the most inliers.
struct ObjectSearch {
  const FusionInput& frame;
  Image<float> weight;  // of each pixel
  Mat6 start_cov;
  double min_inliers;
  FusionConfig config;

  TrackResult from(const std::vector<SE3>& starts, const FusionState& m) const {
    const int levels = config.tracking.levels;
    const std::vector<TrackReference> reference =
        makeReference(m.object.prediction, levels, m.stable);
    const WeightPyramid weights = weightPyramid(weight, levels);
    TrackResult best;
    best.T_PC = starts.front();
    best.covariance = start_cov;
    for (const SE3& start : starts) {
      const TrackResult r =
          alignToModel(reference, frame.pyramid, weights, start, start_cov, min_inliers, config);
      const bool better = r.accepted ? !best.accepted || r.inliers > best.inliers
                                     : !best.accepted && best.inlier_share == 0;
      if (better) best = r;
    }
    return best;
  }
};

// `step_cov`: of the step that is taken where nothing could be aligned.
void setObject(const TrackResult& r, const Mat6& step_cov, FusionState& m) {
  m.object.T_FC = m.object.T_FC * r.T_PC;
  m.object_pose.inliers = r.inliers;
  m.object_pose.rms_residual = r.rms_m;
  m.object_on_map = r.accepted;
  m.covariance_OC = relativeCovariance(r, step_cov, m);
  placeObject(m);
}

// Takes the object's pose as good although its model does not say so: where the model is too small
// to say anything, and where it is in view and has not fitted for a second - then it is wrong, and
// starts anew.
void trustUntracked(bool enough, FusionState& m) {
  const bool small = static_cast<double>(m.object.map.size()) < kSmallModel * m.minObjectPixels();
  m.misfit_frames = enough ? m.misfit_frames + 1 : m.misfit_frames;
  if (!small && m.misfit_frames < kMostMisfits) return;
  if (!small) {
    const SE3 T_FC = m.object.T_FC;
    m.object = BodyModel(m.config, m.camera);
    m.object.T_FC = T_FC;
  }
  m.object_found = true;
}

/// Of the object: its model is seen there all the same, or it is taken to move on as it did.
enum class Leap : std::uint8_t { kNone, kSeen, kRefused };

// For a step that no body makes, seen from a camera that knows where it is: the object is looked
// for where it would be if it moved on, and where it rests. Where its model is not seen to leap it
// stays in motion, and has to be found again.
Leap mendLeap(const ObjectSearch& search, double seconds, FusionState& m, TrackResult& r) {
  if (m.camera_pose.health != Health::kTracked) return Leap::kNone;
  const SE3 steady = steadyStep(seconds, m);
  if (!jumps(r.T_PC, steady, seconds)) return Leap::kNone;
  if (enoughInView(m)) {
    const TrackResult near = search.from({steady, restingStep(m)}, m);
    if (near.accepted && (!r.accepted || near.inliers > r.inliers)) r = near;
  }
  if (r.accepted) return jumps(r.T_PC, steady, seconds) ? Leap::kSeen : Leap::kNone;
  r.T_PC = steady;
  m.object_found = false;
  return Leap::kRefused;
}

// Refines the moving object's pose; whether the frame may be fused into its model.
bool trackObject(const FusionInput& f, const SegmentationResult& s, FusionState& m) {
  const bool gap = m.bridged(s);
  const SE3 T_WO = m.T_WO;
  const double seconds = m.secondsSince(s.utime);
  const SE3 start = gap ? restingStep(m) : s.object.T_AB;
  ObjectSearch search{
      f, f.weights.object.own,
      startCovariance(s.object.covariance, m.config.tracking, gap ? kGapInflation : 1.0),
      kFewPixels * m.minObjectPixels(), m.config};
  TrackResult r;
  r.T_PC = start;
  r.covariance = search.start_cov;
  const bool enough = enoughInView(m);
  if (enough) r = search.from({start}, m);
  if (enough && !r.accepted && !m.object_found) {
    search.start_cov *= kSearchInflation;
    search.config = wideSearch(m.config);
    const TrackResult again = search.from({start}, m);
    if (again.accepted) r = again;
  }
  const Leap leap = mendLeap(search, seconds, m, r);
  const bool wide = gap || leap == Leap::kRefused;
  setObject(r, wide ? search.start_cov : stepCovariance(s.object.covariance, m.config.tracking), m);
  m.object_found = m.object_found || r.accepted;
  if (m.object_found) m.misfit_frames = 0;
  if (!m.object_found) trustUntracked(enough, m);
  const bool sure = r.accepted && !gap && !m.blind && leap == Leap::kNone;
  if (sure && seconds > 0) m.object_velocity = (T_WO.inverse() * m.T_WO).log() / seconds;
  // A pose in the world is worth no more than the camera's.
  m.object_pose.health = worse(m.camera_pose.health,
                               sure ? Health::kTracked : worse(s.object.health, Health::kDegraded));
  return m.object_found && !m.blind && leap == Leap::kNone &&
         (r.accepted || !enough || r.inlier_share == 0);
}

// Depth that the static map does not explain: there the object may be, mask or not.
Image<float> unexplained(const FusionInput& f, const FusionState& m) {
  const Image<std::uint8_t> world = explainedBy(m.world.prediction, f.maps, m.config);
  Image<float> out = everywhere(f.maps.depth);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = world[i] != 0 ? 0.0F : out[i];
  return out;
}

// Takes the object where its prior says, and looks for it there and where it rested.
void coast(const FusionInput& f, const SegmentationResult& s, FusionState& m) {
  const SE3 rest = restingStep(m);
  const SE3 start = m.bridged(s) ? rest : s.object.T_AB;
  ObjectSearch search{f, unexplained(f, m),
                      startCovariance(s.object.covariance, m.config.tracking, kGapInflation),
                      m.minObjectPixels(), m.config};
  TrackResult r;
  r.T_PC = start;
  r.covariance = search.start_cov;
  if (enoughInView(m)) {
    r = search.from({start, rest}, m);
    if (!r.accepted && !m.object_found) {
      search.start_cov *= kSearchInflation;
      search.config = wideSearch(m.config);
      r = search.from({start}, m);
    }
  }
  setObject(r, stepCovariance(s.object.covariance, m.config.tracking), m);
  m.object_found = r.accepted;
  m.object_pose.health = r.accepted ? worse(Health::kTracked, m.camera_pose.health)
                                    : worse(s.object.health, Health::kPriorOnly);
}

// Makes the object's stable surfels part of the static map.
void joinWorld(FusionState& m) {
  const SE3 T_FO = m.T_WF.inverse() * m.T_WO;
  for (int i = 0; i < m.object.map.blocks(); ++i) {
    const SurfelBlock& b = m.object.map.block(i);
    for (int slot = 0; slot < b.count; ++slot) {
      Surfel s = b.get(slot);
      if (s.logit < m.stable) continue;
      s.born = s.seen = m.time;
      m.world.map.append(moved(s, T_FO));
    }
  }
  dropObject(m);
}

}  // namespace

ObjectSigns signsOf(const SegmentationResult& s, const FusionState& m) {
  ObjectSigns signs;
  signs.moving = s.object_moving;
  signs.unseen = s.object.health == Health::kPriorOnly ||
                 (s.object_moving && s.object.health == Health::kLost);
  signs.share = s.dynamic_share;
  signs.travelled_m = (m.T_WO.t - m.T_WO_birth.t).norm();
  signs.rested_s = static_cast<double>(s.utime - m.rest_utime) * 1e-6;
  return signs;
}

bool followObject(const FusionInput& f, const SegmentationResult& s, ObjectAction action,
                  FusionState& m) {
  if (action != ObjectAction::kRest) m.rest_utime = s.utime;
  if (action != ObjectAction::kMove) m.object_velocity.setZero();
  switch (action) {
    case ObjectAction::kNothing:
      m.object_pose.health = Health::kLost;
      return false;
    case ObjectAction::kForget:
      dropObject(m);
      return false;
    case ObjectAction::kJoin:
      joinWorld(m);
      return false;
    case ObjectAction::kRest:
      m.object.T_FC = m.T_WO.inverse() * m.camera_pose.T_W;
      return false;
    case ObjectAction::kCoast:
      coast(f, s, m);
      return false;
    case ObjectAction::kBirth:
      giveBirth(s, m);
      return true;
    case ObjectAction::kMove:
      break;
  }
  return trackObject(f, s, m);
}

void notePlace(ObjectAction action, FusionState& m) {
  const SE3 T_FO = m.T_WF.inverse() * m.T_WO;
  if (action == ObjectAction::kBirth) m.places = {{T_FO, m.config.object.onset_m, m.time}};
  if (m.places.empty()) return;
  RestPlace& last = m.places.back();
  const Vec6 moved = (last.T_FO.inverse() * T_FO).log();
  const double shift = (last.T_FO.t - T_FO.t).norm();
  last.open = last.open && shift < kLeaving;
  if (last.open) last.left = m.time;
  const bool same =
      last.open && shift < m.config.object.shared_m && moved.tail<3>().norm() < kTurned;
  if (action != ObjectAction::kRest || same) return;
  last.open = false;
  m.places.push_back({T_FO, m.config.object.shared_m, m.time});
  if (m.places.size() > kMostPlaces) m.places.erase(m.places.begin());
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
