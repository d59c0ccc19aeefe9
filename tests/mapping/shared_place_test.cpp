// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/shared_place.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr int kSide = 12;        // surfels along a side of the patch
constexpr double kPitch = 0.01;  // metres between them
constexpr float kStable = -1.1F;

Surfel surfelAt(const Vec3& point, const Vec3& normal, std::int32_t seen) {
  Surfel s;
  s.point = point.cast<float>();
  s.normal = normal.cast<float>();
  s.radius = 0.01F;
  s.logit = 2.0F;
  s.weight = 1.0F;
  s.born = s.seen = seen;
  return s;
}

// Point i of a patch, row by row, in the object's frame.
Vec3 patchPoint(int i, double z) {
  const int row = i / kSide;
  return {kPitch * (i % kSide), kPitch * row, z};
}

// A patch in the plane z = 0 of the object, facing -z.
SurfelMap objectPatch() {
  SurfelMap map;
  for (int i = 0; i < kSide * kSide; ++i) {
    map.append(surfelAt(patchPoint(i, 0), -Vec3::UnitZ(), 1));
  }
  return map;
}

struct Place {
  SE3 T_FO = SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3::UnitY())), Vec3(1.0, -0.4, 2.0));
  std::int32_t left = 50;
};

// World surfels over the middle of the patch, `off` before or behind it.
SurfelMap worldPatch(const Place& place, double off, const Vec3& normal_O, std::int32_t seen) {
  SurfelMap map;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec3 p_O = patchPoint(i, off) + Vec3(0.003, 0, 0);
    map.append(surfelAt(place.T_FO * p_O, place.T_FO.R() * normal_O, seen));
  }
  return map;
}

std::int64_t left(SurfelMap world, const Place& place, double reach_m = 0.03) {
  const std::int64_t before = world.size();
  const std::int64_t removed =
      removeShared(objectPatch(), {{place.T_FO, reach_m, place.left, false}}, kStable, world);
  EXPECT_EQ(world.size(), before - removed);
  return world.size();
}

TEST(SharedPlace, TakesWhatCoincidesWithTheObjectWhereItStood) {
  const Place place;
  const Vec3 facing = -Vec3::UnitZ();
  EXPECT_EQ(left(worldPatch(place, 0.0, facing, 40), place), 0);
  EXPECT_EQ(left(worldPatch(place, 0.02, facing, 40), place), 0);
  EXPECT_EQ(left(worldPatch(place, -0.02, facing, 50), place), 0) << "seen when it left";
}

TEST(SharedPlace, LeavesWhatIsFartherFacesAnotherSideOrWasSeenAfterwards) {
  const Place place;
  const Vec3 facing = -Vec3::UnitZ();
  const std::int64_t all = kSide * kSide;
  EXPECT_EQ(left(worldPatch(place, 0.04, facing, 40), place), all) << "farther";
  EXPECT_EQ(left(worldPatch(place, 0.04, facing, 40), place, 0.08), 0) << "with a longer reach";
  EXPECT_EQ(left(worldPatch(place, 0.0, Vec3::UnitX(), 40), place), all) << "like the floor";
  EXPECT_EQ(left(worldPatch(place, 0.0, Vec3::UnitZ(), 40), place), all) << "a back side";
  EXPECT_EQ(left(worldPatch(place, 0.0, facing, 51), place), all) << "seen afterwards";
  Place other = place;
  other.T_FO.t.x() += 0.3;
  EXPECT_EQ(left(worldPatch(place, 0.0, facing, 40), other), all) << "another place";
}

TEST(SharedPlace, UnstableSurfelsOfTheObjectAreNoWitnesses) {
  const Place place;
  SurfelMap object;
  Surfel s = surfelAt(Vec3::Zero(), -Vec3::UnitZ(), 1);
  s.logit = -3.0F;
  object.append(s);
  SurfelMap world = worldPatch(place, 0.0, -Vec3::UnitZ(), 40);
  EXPECT_EQ(removeShared(object, {{place.T_FO, 0.03, 50, false}}, kStable, world), 0);
  EXPECT_EQ(removeShared(objectPatch(), {}, kStable, world), 0) << "it never stood";
}

}  // namespace
}  // namespace rf
