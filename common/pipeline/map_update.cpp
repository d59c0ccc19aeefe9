// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/map_update.hpp"

#include <cstdint>
#include <vector>

#include "mapping/body_model.hpp"
#include "mapping/shared_place.hpp"
#include "mapping/surfel_fusion.hpp"

namespace rf {
namespace {

constexpr double kCarveFactor =
    100.0;                            // at birth the object's surfels leave the static map at once
constexpr double kYoungFactor = 3.0;  // ... and soon while the model is young
constexpr int kYoungFrames = 10;

// Factor on what a world surfel loses where the object is seen.
double missFactor(ObjectAction action, const ObjectLife& life) {
  if (action == ObjectAction::kBirth) return kCarveFactor;
  const bool young = action == ObjectAction::kMove && life.moving_frames <= kYoungFrames;
  return young ? kYoungFactor : 1.0;
}

// A place that is known to a few centimetres alone has to wait until the object has left it: what
// stands there for good is seen then.
std::vector<RestPlace> placesToClear(const FusionState& m) {
  std::vector<RestPlace> out;
  for (const RestPlace& p : m.places) {
    const bool rough = p.reach_m > m.config.object.shared_m;
    if (p.reach_m > 0 && !(rough && p.open)) out.push_back(p);
  }
  return out;
}

}  // namespace

void predictModels(ObjectAction action, FusionState& m) {
  const PredictOptions options = PredictOptions::from(m.config);
  m.world.predictor.predict(m.world.map, m.world.T_FC, m.camera, options, m.world.prediction);
  if (action == ObjectAction::kMove || action == ObjectAction::kRest ||
      action == ObjectAction::kCoast) {
    m.object.predictor.predict(m.object.map, m.object.T_FC, m.camera, options, m.object.prediction);
  }
}

void fuseModels(const FusionInput& f, ObjectAction action, MayFuse may, FusionState& m) {
  const Image<std::uint8_t> none;
  const Image<std::uint8_t> object_explains =
      m.life.phase != ObjectPhase::kNone ? explainedBy(m.object.prediction, f.maps, m.config)
                                         : none;
  const Image<std::uint8_t> world_explains =
      action == ObjectAction::kMove ? explainedBy(m.world.prediction, f.maps, m.config) : none;
  if (may.world) {
    const FuseInput in{
        f.maps, f.weights.world, f.weights.object.interior, object_explains, m.world.T_FC,
        m.time, !m.started,      missFactor(action, m.life)};
    const FuseStats stats = fuseFrame(in, m.config, m.world.map, m.world.prediction);
    m.world.cleaner.noteGrowth(stats.grown, m.time);
  }
  if (may.object) {
    const bool first = action == ObjectAction::kBirth;
    const FuseInput in{f.maps,         f.weights.object, f.weights.world.interior,
                       world_explains, m.object.T_FC,    m.time,
                       first};
    const FuseStats stats = fuseFrame(in, m.config, m.object.map, m.object.prediction);
    m.object.cleaner.noteGrowth(stats.grown, m.time);
  }
}

void cleanModels(const FusionInput& f, ObjectAction action, MayFuse may, FusionState& m) {
  if (may.world) {
    m.world.cleaner.clean(f.maps, m.world.T_FC, m.time, m.config, m.world.prediction.blocks,
                          m.world.map);
  }
  if (may.object && action == ObjectAction::kMove) {
    m.object.cleaner.clean(f.maps, m.object.T_FC, m.time, m.config, m.object.prediction.blocks,
                           m.object.map);
  }
  if (m.life.phase != ObjectPhase::kNone && m.time % m.config.object.shared_every == 0) {
    removeShared(m.object.map, placesToClear(m), m.stable, m.world.map);
  }
}

}  // namespace rf
