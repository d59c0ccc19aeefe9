// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/object_life.hpp"

namespace rf {

ObjectAction advance(ObjectLife& life, bool moving, double share, double travelled_m,
                     const ObjectModelConfig& config) {
  if (life.phase == ObjectPhase::kNone) {
    if (!moving || !(share >= config.birth_share)) return ObjectAction::kNothing;
    life = {ObjectPhase::kMoving, 1};
    return ObjectAction::kBirth;
  }
  if (moving) {
    life.phase = ObjectPhase::kMoving;
    ++life.moving_frames;
    return ObjectAction::kMove;
  }
  const bool false_alarm =
      life.moving_frames <= config.false_birth_frames && travelled_m < config.false_birth_m;
  if (life.phase == ObjectPhase::kMoving && false_alarm) {
    life = {};
    return ObjectAction::kForget;
  }
  life.phase = ObjectPhase::kResting;
  return ObjectAction::kRest;
}

}  // namespace rf
