// SPDX-License-Identifier: BSD-3-Clause
// What fusion says of the camera's pose, given the outcome of its alignment.
#include <cmath>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "pipeline/camera_health.hpp"
#include "pipeline/pose_uncertainty.hpp"
#include "pipeline/wide_search.hpp"

namespace rf {
namespace {

constexpr double kMinInliers = 768;  // 1 % of 320x240

class CameraHealth : public testing::Test {
 protected:
  CameraHealth() : m(FusionConfig(), test::testCamera()) {
    m.camera_pose.covariance = Mat6::Identity() * 1e-6;
    s.camera.health = Health::kTracked;
  }

  static TrackResult aligned(double pairs = 40000) {
    TrackResult r;
    r.accepted = true;
    r.pairs = pairs;
    r.inliers = 0.95 * pairs;
    r.inlier_share = 0.95;
    r.likeness = 0.98;
    r.covariance = Mat6::Identity() * 4e-6;
    return r;
  }
  static TrackResult rejected(double pairs) {
    TrackResult r;
    r.pairs = pairs;
    r.inliers = 0.3 * pairs;
    r.inlier_share = pairs > 0 ? 0.3 : 0.0;
    return r;
  }
  Health judge(const TrackResult& r, bool gap = false, bool leap = false, bool jump = false) {
    judgeCamera({r, s, step, kMinInliers, gap, leap, jump}, m);
    return m.camera_pose.health;
  }

  FusionState m;
  SegmentationResult s;
  Mat6 step = Mat6::Identity() * 1e-6;
};

TEST_F(CameraHealth, AnAlignedPoseIsTrackedWithTheAlignmentsCovariance) {
  EXPECT_EQ(judge(aligned()), Health::kTracked);
  EXPECT_TRUE(m.camera_on_map);
  EXPECT_EQ(m.camera_pose.covariance, aligned().covariance);
}

TEST_F(CameraHealth, LittleSurfaceOrAGapDegrades) {
  EXPECT_EQ(judge(aligned(4.0 * kMinInliers)), Health::kDegraded);
  m.usual_pairs = 0;
  EXPECT_EQ(judge(aligned(), true), Health::kDegraded);
}

TEST_F(CameraHealth, AStepThatNoCameraMakesDegrades) {
  EXPECT_EQ(judge(aligned(), false, false, true), Health::kDegraded);
  EXPECT_EQ(judge(aligned()), Health::kTracked) << "of that frame only";

  const SE3 steady(Eigen::Quaterniond::Identity(), {0.03, 0, 0});  // 1 m/s at 30 Hz
  const auto moved = [](double x) { return SE3(Eigen::Quaterniond::Identity(), {x, 0, 0}); };
  EXPECT_FALSE(jumps(moved(0.0), steady, 0.033)) << "a dead stop";
  EXPECT_FALSE(jumps(moved(0.125), steady, 0.033));
  EXPECT_TRUE(jumps(moved(0.135), steady, 0.033));
  EXPECT_TRUE(jumps(moved(-0.08), steady, 0.033));
  EXPECT_FALSE(jumps(moved(0.22), steady, 0.1)) << "2 g at 10 Hz: 20 cm";
  EXPECT_TRUE(jumps(moved(0.24), steady, 0.1));
}

TEST_F(CameraHealth, ABlindPictureDegrades) {
  TrackResult r = aligned();
  r.blind = true;
  EXPECT_EQ(judge(r), Health::kDegraded);
  EXPECT_TRUE(m.blind);
  EXPECT_EQ(judge(aligned()), Health::kTracked);
  EXPECT_FALSE(m.blind);
}

TEST_F(CameraHealth, SupportThatIsGoneSuddenlyDegradesUntilItIsUsual) {
  EXPECT_EQ(judge(aligned(60000)), Health::kTracked);
  EXPECT_EQ(judge(aligned(35000)), Health::kTracked) << "more than half";
  EXPECT_EQ(judge(aligned(15000)), Health::kDegraded);
  int frames = 1;
  while (judge(aligned(15000)) == Health::kDegraded) ++frames;
  EXPECT_GE(frames, 2);
  EXPECT_LE(frames, 8);
}

TEST_F(CameraHealth, AMapThatContradictsGivesTheSearchedRangeOnce) {
  const double shift = m.config.tracking.max_shift_m;
  EXPECT_EQ(judge(rejected(30000)), Health::kDegraded);
  EXPECT_NEAR(m.camera_pose.covariance(0, 0), shift * shift, 1e-4);
  judge(rejected(30000));
  const double both = shift * shift * (1 + kWideShift * kWideShift);
  EXPECT_NEAR(m.camera_pose.covariance(0, 0), both, 1e-4);
  for (int i = 0; i < 10; ++i) judge(rejected(30000));
  EXPECT_NEAR(m.camera_pose.covariance(0, 0), both, 1e-4) << "only the steps are added";
  judge(aligned());
  EXPECT_EQ(m.contradicted_frames, 0);
  EXPECT_EQ(m.camera_pose.covariance, aligned().covariance);
}

TEST_F(CameraHealth, AnUnseenMapContradictsNothing) {
  s.camera.health = Health::kPriorOnly;
  for (int i = 1; i <= 20; ++i) {
    EXPECT_EQ(judge(rejected(0)), Health::kPriorOnly);
    EXPECT_NEAR(m.camera_pose.covariance(2, 2), 1e-6 * (1 + i), 1e-12) << "one step a frame";
  }
  s.camera.health = Health::kLost;
  EXPECT_EQ(judge(rejected(0)), Health::kLost);
}

TEST_F(CameraHealth, APoseInDoubtNeedsMoreToBeBelieved) {
  TrackResult small = aligned(3.0 * kMinInliers);
  EXPECT_TRUE(believed(small, kMinInliers, m));
  TrackResult blind = aligned();
  blind.blind = true;
  EXPECT_TRUE(believed(blind, kMinInliers, m));
  m.camera_pose.covariance *= 1e4;  // 10 cm
  EXPECT_FALSE(believed(small, kMinInliers, m));
  EXPECT_FALSE(believed(blind, kMinInliers, m));
  EXPECT_TRUE(believed(aligned(), kMinInliers, m));
}

TEST_F(CameraHealth, ALeapPutsAnAlignedPoseInDoubt) {
  s.camera.rms_residual = 0.25;
  TrackResult usual = aligned();
  usual.rms_sigma = 0.85;
  for (int i = 0; i < 30; ++i) {
    noteLeap(s, usual, m);
    judge(usual);
  }
  ASSERT_LT(positionSigma(m.camera_pose.covariance), kTrustedSigma);
  TrackResult wall = usual;  // of a teleport in the experiments
  wall.rms_sigma = 1.5;
  wall.likeness = 0.89;
  EXPECT_TRUE(believed(wall, kMinInliers, m)) << "as long as nothing speaks of a leap";
  s.camera.rms_residual = 5;
  TrackResult black = usual;
  black.blind = true;
  m.object_found = true;
  noteLeap(s, black, m);
  EXPECT_LT(positionSigma(m.camera_pose.covariance), kTrustedSigma) << "a black picture is no leap";
  EXPECT_TRUE(m.object_found);
  noteLeap(s, wall, m);
  EXPECT_GT(positionSigma(m.camera_pose.covariance), kTrustedSigma);
  EXPECT_FALSE(m.object_found) << "the object was somewhere else in the view";
  EXPECT_GT(positionSigma(m.covariance_OC), kTrustedSigma);
  EXPECT_FALSE(believed(wall, kMinInliers, m));
  EXPECT_TRUE(believed(usual, kMinInliers, m)) << "the map is found again where it was";
}

TEST(UsualResidual, OneThatStandsOutAndOneThatStays) {
  UsualResidual usual;
  EXPECT_FALSE(usual.exceededBy(2.5)) << "nothing known: three sigma of the sensor";
  for (int i = 0; i < 50; ++i) usual.learn(0.25);
  EXPECT_FALSE(usual.exceededBy(0.7));
  EXPECT_TRUE(usual.exceededBy(0.8));
  int frames = 0;
  for (; usual.exceededBy(5.0); ++frames) usual.learn(5.0);
  EXPECT_GT(frames, 10);
  EXPECT_LT(frames, 30);
}

TEST_F(CameraHealth, AnotherPlacesPictureIsNeverBelieved) {
  TrackResult r = aligned();
  r.likeness = -0.3;
  EXPECT_FALSE(believed(r, kMinInliers, m));
  EXPECT_FALSE(believed(rejected(30000), kMinInliers, m));
}

TEST(PositionSigma, IsThatOfTheWorstDirection) {
  Mat6 P = Mat6::Identity();
  P.topLeftCorner<3, 3>() << 2, 1, 0, 1, 2, 0, 0, 0, 1;  // eigenvalues 3, 1, 1
  EXPECT_NEAR(positionSigma(P), std::sqrt(3.0), 1e-12);
}

}  // namespace
}  // namespace rf
