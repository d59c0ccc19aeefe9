// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/object_life.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace rf {
namespace {

const ObjectSigns kMoves{true, false, 0.2, 0.5, 0.0};
const ObjectSigns kRests{false, false, 0.0, 0.5, 0.0};
const ObjectSigns kUnseen{false, true, 0.0, 0.5, 0.0};

ObjectLife moving(const ObjectModelConfig& config, int frames = 10) {
  ObjectLife life;
  EXPECT_EQ(advance(life, kMoves, config), ObjectAction::kBirth);
  for (int i = 1; i < frames; ++i) EXPECT_EQ(advance(life, kMoves, config), ObjectAction::kMove);
  return life;
}

TEST(ObjectLife, IsBornOnceItMovesAndIsLargeEnough) {
  const ObjectModelConfig config;
  ObjectLife life;
  ObjectSigns small = kMoves;
  small.share = 0.5 * config.birth_share;
  EXPECT_EQ(advance(life, kRests, config), ObjectAction::kNothing);
  EXPECT_EQ(advance(life, kUnseen, config), ObjectAction::kNothing);
  EXPECT_EQ(advance(life, small, config), ObjectAction::kNothing);
  small.share = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(advance(life, small, config), ObjectAction::kNothing);
  EXPECT_EQ(advance(life, kMoves, config), ObjectAction::kBirth);
}

TEST(ObjectLife, RestsAndMovesOn) {
  const ObjectModelConfig config;
  ObjectLife life = moving(config);
  EXPECT_EQ(advance(life, kRests, config), ObjectAction::kRest);
  EXPECT_EQ(life.phase, ObjectPhase::kResting);
  EXPECT_EQ(advance(life, kMoves, config), ObjectAction::kMove);
}

TEST(ObjectLife, AFalseAlarmIsForgotten) {
  const ObjectModelConfig config;
  ObjectLife life = moving(config, 2);
  ObjectSigns still = kRests;
  still.travelled_m = 0.5 * config.false_birth_m;
  EXPECT_EQ(advance(life, still, config), ObjectAction::kForget);
  EXPECT_EQ(life.phase, ObjectPhase::kNone);
}

TEST(ObjectLife, CoastsWhileUnseenFromRestAndFromMotion) {
  ObjectModelConfig config;
  ObjectLife life = moving(config);
  EXPECT_EQ(advance(life, kUnseen, config), ObjectAction::kCoast);
  EXPECT_EQ(life.phase, ObjectPhase::kCoasting);
  EXPECT_EQ(advance(life, kRests, config), ObjectAction::kRest);
  EXPECT_EQ(advance(life, kUnseen, config), ObjectAction::kCoast);
  EXPECT_EQ(advance(life, kMoves, config), ObjectAction::kMove);
  config.coast = false;
  EXPECT_EQ(advance(life, kUnseen, config), ObjectAction::kRest);
}

TEST(ObjectLife, JoinsTheMapAfterItsTimeOrNever) {
  ObjectModelConfig config;
  ObjectLife life = moving(config);
  ObjectSigns long_rest = kRests;
  long_rest.rested_s = 1e5;
  EXPECT_EQ(advance(life, long_rest, config), ObjectAction::kRest);
  EXPECT_EQ(advance(life, long_rest, config), ObjectAction::kRest) << "never by default";
  config.join_after_s = 5.0;
  long_rest.rested_s = 4.9;
  EXPECT_EQ(advance(life, long_rest, config), ObjectAction::kRest);
  long_rest.rested_s = 5.0;
  EXPECT_EQ(advance(life, long_rest, config), ObjectAction::kJoin);
  EXPECT_EQ(life.phase, ObjectPhase::kNone);
  EXPECT_EQ(advance(life, kMoves, config), ObjectAction::kBirth) << "born anew";
}

}  // namespace
}  // namespace rf
