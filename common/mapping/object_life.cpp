// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/object_life.hpp"

namespace rf {
namespace {

ObjectAction rest(ObjectLife& life, const ObjectSigns& signs, const ObjectModelConfig& config) {
  const bool false_alarm =
      life.moving_frames <= config.false_birth_frames && signs.travelled_m < config.false_birth_m;
  if (life.phase == ObjectPhase::kMoving && false_alarm) {
    life = {};
    return ObjectAction::kForget;
  }
  if (life.phase == ObjectPhase::kResting && config.join_after_s > 0 &&
      signs.rested_s >= config.join_after_s) {
    life = {};
    return ObjectAction::kJoin;
  }
  life.phase = ObjectPhase::kResting;
  return ObjectAction::kRest;
}

}  // namespace

ObjectAction advance(ObjectLife& life, const ObjectSigns& signs, const ObjectModelConfig& config) {
  if (life.phase == ObjectPhase::kNone) {
    if (!signs.moving || !(signs.share >= config.birth_share)) return ObjectAction::kNothing;
    life = {ObjectPhase::kMoving, 1};
    return ObjectAction::kBirth;
  }
  if (signs.unseen && config.coast) {
    life.phase = ObjectPhase::kCoasting;
    return ObjectAction::kCoast;
  }
  if (!signs.moving) return rest(life, signs, config);
  life.phase = ObjectPhase::kMoving;
  ++life.moving_frames;
  return ObjectAction::kMove;
}

}  // namespace rf
