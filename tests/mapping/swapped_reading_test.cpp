// SPDX-License-Identifier: BSD-3-Clause
// A camera without a prior beside a body that fills most of the view: which of both moves is not
// known, and the poses have to say so.
#include "pipeline/swapped_reading.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr double kStep = 0.02;  // metres that the body moves in each frame

SegmentationResult seen(double dynamic_share, bool prior) {
  SegmentationResult s;
  s.object_moving = true;
  s.dynamic_share = dynamic_share;
  s.has_prior_T_WC = prior;
  return s;
}

SE3 moved(int frames) {
  SE3 out;
  out.t.x() = kStep * frames;
  return out;
}

BodyPose tracked(const SE3& T_W) {
  BodyPose pose;
  pose.T_W = T_W;
  pose.covariance = Mat6::Identity() * 1e-6;
  pose.health = Health::kTracked;
  return pose;
}

SwappedReading after(int frames, double dynamic_share, bool prior) {
  SwappedReading out;
  for (int i = 0; i < frames; ++i) out.observe(seen(dynamic_share, prior), i == 0, moved(i));
  return out;
}

TEST(SwappedReading, DegradesBothPosesOnceTheBodyHasMovedFar) {
  EXPECT_EQ(after(2, 0.6, false).widened(tracked({})).health, Health::kTracked);  // 2 cm
  const SwappedReading far = after(11, 0.6, false);                               // 20 cm
  for (const SE3& T_W : {SE3(), moved(10)}) {
    const BodyPose pose = far.widened(tracked(T_W));
    EXPECT_EQ(pose.health, Health::kDegraded);
    EXPECT_NEAR(pose.covariance(0, 0), 0.2 * 0.2, 1e-5);
    EXPECT_NEAR(pose.covariance(3, 3), 0, 1e-5);
  }
}

TEST(SwappedReading, IsImpossibleWithAPriorOrASmallBody) {
  EXPECT_EQ(after(11, 0.6, true).widened(tracked({})).health, Health::kTracked);
  EXPECT_EQ(after(11, 0.4, false).widened(tracked({})).health, Health::kTracked);
}

TEST(SwappedReading, StaysWhenTheBodyGrowsLaterRestsGoesOrIsBornAgain) {
  SwappedReading reading = after(11, 0.4, false);
  reading.observe(seen(0.6, false), false, moved(11));
  SegmentationResult rest = seen(0, false);
  rest.object_moving = false;
  reading.observe(rest, false, moved(11));
  reading.observe(rest, false, std::nullopt);
  EXPECT_NEAR(reading.widened(tracked({})).covariance(0, 0), 0.22 * 0.22, 1e-5);
  reading.observe(seen(0.1, false), true, SE3());  // another model: its place is no motion
  EXPECT_NEAR(reading.widened(tracked({})).covariance(0, 0), 0.22 * 0.22, 1e-5);
  reading.observe(seen(0.1, false), false, moved(-11));  // all the way back
  EXPECT_EQ(reading.widened(tracked({})).health, Health::kTracked);
}

}  // namespace
}  // namespace rf
