// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_correction.hpp"

#include <gtest/gtest.h>

#include "mapping/map_uncertainty.hpp"

namespace rf {
namespace {

Surfel surfelBornAt(int time) {
  Surfel s;
  s.point = {1.0F, 2.0F, 3.0F};
  s.normal = {0.0F, 0.0F, 1.0F};
  s.radius = 0.01F;
  s.born = s.seen = time;
  return s;
}

TEST(MoveByBirth, MovesEachPieceByItsOwnTwist) {
  const int later = 40;
  ASSERT_NE(MapUncertainty::epochOf(0), MapUncertainty::epochOf(later));
  SurfelMap map;
  const std::uint32_t stays = map.append(surfelBornAt(0));
  const std::uint32_t moves = map.append(surfelBornAt(later));
  const std::uint32_t newer = map.append(surfelBornAt(10 * later));
  std::vector<Vec6> twists(MapUncertainty::epochOf(later) + 1, Vec6::Zero());
  twists.back() << 0.1, -0.05, 0.02, 0.03, 0.01, -0.2;
  moveByBirth(twists, map);
  const SE3 T = SE3::exp(twists.back());
  const Vec3 p = T.R() * Vec3(1, 2, 3) + T.t;
  EXPECT_LT((map.get(moves).point.cast<double>() - p).norm(), 1e-6);
  EXPECT_LT((map.get(moves).normal.cast<double>() - T.R().col(2)).norm(), 1e-6);
  EXPECT_EQ(map.get(stays).point, surfelBornAt(0).point);
  EXPECT_EQ(map.get(newer).point, surfelBornAt(0).point);
  const SurfelBlock& block = map.block(0);
  EXPECT_TRUE((block.lower.array() <= map.get(moves).point.array()).all() &&
              (block.upper.array() >= map.get(moves).point.array()).all())
      << "the box of the block holds it";
}

}  // namespace
}  // namespace rf
