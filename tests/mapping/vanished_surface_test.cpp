// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/vanished_surface.hpp"

#include <numeric>

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr float kPitch = 0.01F;     // metres
constexpr std::int32_t kLeft = 50;  // frame in which somebody gets up

using Surfels = std::vector<Surfel>;

// A patch of columns x rows surfels, facing the camera, from `corner` on.
Surfels patch(const Eigen::Vector3f& corner, int columns, int rows, std::int32_t seen = kLeft) {
  Surfels surfels;
  for (int v = 0; v < rows; ++v) {
    for (int u = 0; u < columns; ++u) {
      Surfel s;
      s.point = corner + kPitch * Eigen::Vector3f(static_cast<float>(u), static_cast<float>(v), 0);
      s.seen = seen;
      surfels.push_back(s);
    }
  }
  return surfels;
}

Surfels wall() { return patch({-1, -1, 3}, 200, 200); }
Surfels lap(std::int32_t seen = kLeft) { return patch({0, 0, 1.5F}, 40, 10, seen); }
Surfels trunk() { return patch({0, -0.6F, 1.5F}, 40, 60); }  // ends where the lap begins

Surfels joined(Surfels all, const Surfels& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

VanishedSurface vanished(const Surfels& surfels) {
  VanishedSurface v;
  for (const Surfel& s : surfels) v.add(s.point, kLeft);
  return v;
}

int count(const std::vector<std::uint8_t>& marks) {
  return std::accumulate(marks.begin(), marks.end(), 0);
}

TEST(VanishedSurface, WhatIsLeftOfAThingThatHasGoneIsARemnant) {
  const std::vector<std::uint8_t> marks = vanished(trunk()).remnants(joined(wall(), lap()));
  ASSERT_EQ(marks.size(), wall().size() + lap().size());
  EXPECT_EQ(count(marks), static_cast<int>(lap().size()));
  EXPECT_EQ(marks.front(), 0) << "the wall";
  EXPECT_EQ(marks.back(), 1) << "the lap";
}

TEST(VanishedSurface, WhatIsStillMeasuredLaterStandsByItself) {
  const auto left = [](std::int32_t seen) {
    return count(vanished(trunk()).remnants(joined(wall(), lap(seen))));
  };
  EXPECT_GT(left(kLeft + VanishedSurface::kSettled - 1), 0);
  EXPECT_EQ(left(kLeft + VanishedSurface::kSettled), 0) << "a chair, not a lap";
}

TEST(VanishedSurface, NothingIsARemnantWithoutSurfaceThatHasGone) {
  EXPECT_EQ(count(VanishedSurface().remnants(joined(wall(), lap()))), 0);
  EXPECT_TRUE(vanished(trunk()).remnants({}).empty());
}

TEST(VanishedSurface, AThingOfWhichMostIsThereIsNone) {
  const Surfels edge = patch({0, -0.05F, 1.5F}, 40, 5);
  EXPECT_EQ(count(vanished(edge).remnants(joined(wall(), lap()))), 0);
}

TEST(VanishedSurface, WhatDoesNotTouchItIsNone) {
  const Surfels elsewhere = patch({0, -0.7F, 1.5F}, 40, 60);  // a gap of ten centimetres
  EXPECT_EQ(count(vanished(elsewhere).remnants(joined(wall(), lap()))), 0);
}

TEST(VanishedSurface, AWorldIsNone) {
  // Somebody who touched it has passed before the wall: more of him has gone than there is wall.
  Surfels people;
  for (int i = 0; i < 8; ++i) {
    people = joined(people, patch({-1, -1, 3.0F - 0.03F * static_cast<float>(i + 1)}, 200, 200));
  }
  EXPECT_EQ(count(vanished(people).remnants(wall())), 0);
}

TEST(VanishedSurface, SurfaceThatIsThereAgainHasNotGone) {
  EXPECT_EQ(count(vanished(trunk()).remnants(joined(joined(wall(), trunk()), lap()))), 0);
}

TEST(VanishedSurface, DoesNotDependOnTheOrder) {
  const Surfels body = trunk();
  const Surfels map = joined(wall(), lap());
  const std::vector<std::uint8_t> marks = vanished(body).remnants(map);
  EXPECT_EQ(vanished(Surfels(body.rbegin(), body.rend())).remnants(map), marks);
  const std::vector<std::uint8_t> backwards =
      vanished(body).remnants(Surfels(map.rbegin(), map.rend()));
  EXPECT_EQ(std::vector<std::uint8_t>(backwards.rbegin(), backwards.rend()), marks);
}

TEST(VanishedSurface, ACellIsNotedOnce) {
  EXPECT_EQ(vanished(joined(trunk(), trunk())).cells(), vanished(trunk()).cells());
  EXPECT_LT(vanished(trunk()).cells(), trunk().size());
}

}  // namespace
}  // namespace rf
