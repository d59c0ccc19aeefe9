// SPDX-License-Identifier: BSD-3-Clause
#include "priors/grasp_timeline.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rf {
namespace {

SE3 at(double x) { return {Eigen::Quaterniond::Identity(), Vec3(x, 0, 0)}; }

TEST(GraspTimeline, HoldsFromGraspToRelease) {
  GraspTimeline grasps(0);
  EXPECT_EQ(grasps.between(0, 10).reason, "nothing was grasped yet");
  EXPECT_EQ(grasps.add({100, true, at(0.1)}), "");
  EXPECT_EQ(grasps.add({200, false, SE3()}), "");
  EXPECT_EQ(grasps.add({300, true, at(0.2)}), "");
  EXPECT_FALSE(grasps.between(50, 99).held);
  EXPECT_EQ(grasps.between(90, 110).reason, "grasped between the two frames");
  EXPECT_TRUE(grasps.between(100, 100).held);
  EXPECT_EQ(grasps.between(110, 150).T_GO, at(0.1));
  EXPECT_EQ(grasps.between(190, 200).reason, "the object is not held");
  EXPECT_EQ(grasps.between(150, 350).reason, "grasped between the two frames");
  EXPECT_EQ(grasps.between(301, 302).T_GO, at(0.2));
}

TEST(GraspTimeline, RepetitionChangesNothing) {
  GraspTimeline grasps(0);
  for (std::int64_t t = 100; t <= 500; t += 100) EXPECT_EQ(grasps.add({t, true, at(0.1)}), "");
  EXPECT_TRUE(grasps.between(150, 450).held);
  grasps.add({600, true, at(0.3)});  // another grasp
  EXPECT_FALSE(grasps.between(550, 650).held);
}

TEST(GraspTimeline, SaysWhatIsWrong) {
  GraspTimeline grasps(0);
  SE3 bad = at(NAN);
  EXPECT_EQ(grasps.add({1, true, bad}), "T_GO is not finite");
  EXPECT_EQ(grasps.add({1, false, bad}), "");  // not looked at
  bad = at(0);
  bad.q.coeffs() *= 0.5;
  EXPECT_EQ(grasps.add({2, true, bad}), "T_GO's quaternion has length 0.5, must be 1");
  EXPECT_EQ(grasps.add({1, true, at(0)}), "it is not later than the grasp before");
  EXPECT_EQ(grasps.add({INT64_MAX, true, at(0)}), "its time is absurd");
  EXPECT_EQ(grasps.counts().refused, 4);
}

TEST(GraspTimeline, OffsetAndClockThatGoesBack) {
  GraspTimeline grasps(0.5);
  grasps.add({10'000'000, true, at(0.1)});
  EXPECT_FALSE(grasps.between(10'400'000, 10'400'000).held);
  EXPECT_TRUE(grasps.between(10'500'000, 10'500'000).held);
  EXPECT_EQ(grasps.add({1'000'000, false, SE3()}), "time went back: later grasps are forgotten");
  EXPECT_FALSE(grasps.between(10'600'000, 10'600'000).held);
  EXPECT_EQ(grasps.counts().restarts, 1);
}

}  // namespace
}  // namespace rf
