// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/turned_reading.hpp"

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "mapping/body_model.hpp"
#include "mapping/shared_place.hpp"
#include "mapping/surfel_fusion.hpp"
#include "mapping/tracker.hpp"
#include "pipeline/camera_health.hpp"
#include "pipeline/map_update.hpp"

namespace rf {
namespace {

// What tells which body is the world does so soon after a birth (segmentation.decision.turn_frames
// is a second). A reading that held for longer is not given up for one in which the mask went
// wrong: where a body came to rest or filled the view, single frames of sideway 4 did, and the
// camera would have gone by all that the body had moved.
constexpr std::int32_t kLatest = 60;  // frames after the birth

// Most of what both models show is labelled as the other body's. Where a reading lasted for a frame
// or two alone, the models know better than the frame before.
bool labelsContradictModels(const FusionInput& f, const FusionState& m) {
  const Prediction& world = m.world.prediction;
  const Prediction& object = m.object.prediction;
  std::int64_t alike = 0;
  std::int64_t contrary = 0;
  for (std::size_t i = 0; i < f.maps.depth.size(); ++i) {
    const float of_world = f.weights.world.own[i];
    const float of_object = f.weights.object.own[i];
    const bool has_world = world.depth[i] > 0 && world.logit[i] >= m.stable;
    const bool has_object = object.depth[i] > 0 && object.logit[i] >= m.stable;
    if (!(of_world > 0 || of_object > 0) || !(has_world || has_object)) continue;
    const bool shows_object = has_object && (!has_world || object.depth[i] < world.depth[i]);
    ++((of_object > of_world) == shows_object ? alike : contrary);
  }
  return contrary > alike;
}

// Adds a map's surfels, moved by T, of which `wanted` is true.
template <class Wanted>
void add(const SurfelMap& from, const SE3& T, SurfelMap& to, Wanted wanted) {
  for (int i = 0; i < from.blocks(); ++i) {
    const SurfelBlock& b = from.block(i);
    for (int slot = 0; slot < b.count; ++slot) {
      const Surfel s = b.get(slot);
      if (wanted(s)) to.append(moved(s, T));
    }
  }
}

bool any(const Surfel&) { return true; }

SurfelMap emptyMap(const FusionState& m) {
  return SurfelMap(m.config.surfels.cell_m, m.config.surfels.max_surfels);
}

// It knows blocks by number: all of them are to be looked at anew.
void restartCleaner(BodyModel& body, std::int32_t time) {
  body.cleaner = SurfelCleaner();
  std::vector<int> blocks(static_cast<std::size_t>(body.map.blocks()));
  std::iota(blocks.begin(), blocks.end(), 0);
  body.cleaner.noteGrowth(blocks, time);
}

// The last frame's camera in the static map as it is left, from this frame: what the map says
// against where the object's model puts it. A body that starts slowly has taken the camera along
// before its birth.
SE3 onOldMap(const FusionInput& f, const SE3& T_AB, FusionState& m) {
  m.world.predictor.predict(m.world.map, m.world.T_FC, m.camera, PredictOptions::from(m.config),
                            m.world.prediction);
  const TrackingConfig& t = m.config.tracking;
  const TrackResult r = alignToModel(
      makeReference(m.world.prediction, t.levels, logit(t.full_confidence)), f.pyramid,
      weightPyramid(f.weights.world.own, t.levels), T_AB,
      startCovariance(Mat6::Zero(), t, kGapInflation), kSureFactor * m.minInliers(), m.config);
  return believed(r, m.minInliers(), m) ? m.world.T_FC * r.T_PC * T_AB.inverse() : m.world.T_FC;
}

// The object's model, as it stood at its birth, becomes part of the static map where that does not
// have the same surface.
void joinWorld(SurfelMap room, FusionState& m) {
  constexpr double kSame = 0.02;  // metres
  const SE3 T_FO = m.world.T_FC * m.object.T_FC.inverse();
  removeShared(m.world.map, {{T_FO.inverse(), kSame, m.time, false}}, m.stable, room);
  add(room, T_FO, m.world.map, any);
}

}  // namespace

void turnReading(const FusionInput& f, const SegmentationResult& s, FusionState& m) {
  if (!s.turned || m.bridged(s) || m.life.phase == ObjectPhase::kNone) return;
  if (m.time - m.birth_time > kLatest || !labelsContradictModels(f, m)) return;
  const SE3 T_WC = m.camera_pose.T_W;
  const SE3 T_FO = m.T_WF.inverse() * m.T_WO_birth;
  SurfelMap room = std::move(m.object.map);
  SurfelMap before = std::move(m.world.map);
  const auto old = [&](const Surfel& p) { return p.seen < m.birth_time; };
  m.world.map = emptyMap(m);
  m.object.map = emptyMap(m);
  add(before, SE3(), m.world.map, old);
  add(before, T_FO.inverse(), m.object.map, [&](const Surfel& p) { return !old(p); });

  m.world.T_FC = T_FO * m.object.T_FC;
  std::swap(m.camera_pose.covariance, m.covariance_OC);
  m.world.T_FC = onOldMap(f, s.camera.T_AB, m);
  joinWorld(std::move(room), m);
  restartCleaner(m.world, m.time);
  restartCleaner(m.object, m.time);

  m.camera_pose.T_W = m.T_WF * m.world.T_FC;
  const SE3 T_WW = m.camera_pose.T_W * T_WC.inverse();
  m.T_WO = T_WW * m.T_WO_birth;
  m.swapped.turn(T_WW, m.T_WO);
  m.object.T_FC = m.T_WO.inverse() * m.camera_pose.T_W;
  m.object_pose.T_W = m.T_WO;
  m.places = {{T_FO, m.config.object.onset_m, m.birth_time}};
  m.object_found = true;
  m.object_velocity.setZero();
  m.misfit_frames = m.rejected_frames = m.contradicted_frames = m.drift_frames = 0;
  const double seconds = m.secondsSince(s.utime);
  if (seconds > 0) m.velocity = s.camera.T_AB.log() / seconds;
  predictModels(ObjectAction::kMove, m);
}

}  // namespace rf
