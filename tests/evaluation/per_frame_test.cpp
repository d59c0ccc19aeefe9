// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/per_frame.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr std::int64_t kStep = 50000;  // us

SE3 at(double x) { return {Eigen::Quaterniond::Identity(), Vec3(x, 0, 0)}; }

/// Rests for 10 poses, moves 1 cm a pose for 10, rests for 5, moves again for 5.
Trajectory restMoveRestMove() {
  Trajectory t;
  double x = 3;
  for (int i = 0; i < 30; ++i) {
    if ((i >= 10 && i < 20) || i >= 25) x += 0.01;
    t.push_back({i * kStep, at(x)});
  }
  return t;
}

TEST(PerFrame, DisplacementStartsAnewAfterEachRest) {
  const std::vector<double> d = displacementsSinceRest(restMoveRestMove(), 1e-3);
  EXPECT_NEAR(d[5], 0.0, 1e-12);
  EXPECT_NEAR(d[12], 0.03, 1e-12);
  EXPECT_NEAR(d[19], 0.10, 1e-12) << "half a step of speed is left: it does not rest yet";
  EXPECT_NEAR(d[22], 0.0, 1e-12);
  EXPECT_NEAR(d[26], 0.02, 1e-12) << "counted from the second rest, not from the first";
}

TEST(PerFrame, WithoutRestItCountsFromTheFirstPose) {
  Trajectory t;
  for (int i = 0; i < 5; ++i) t.push_back({i * kStep, at(0.02 * i)});
  EXPECT_NEAR(displacementsSinceRest(t, 1e-3)[4], 0.08, 1e-12);
  EXPECT_TRUE(displacementsSinceRest({}, 1e-3).empty());
}

TEST(PerFrame, ErrorsAreThoseOfTheAlignedPosesAndAbsentWithoutAPose) {
  const Trajectory object_truth = restMoveRestMove();
  Trajectory camera_truth;
  Trajectory camera;
  Trajectory object;
  std::vector<std::int64_t> frames;
  for (int i = 0; i < 30; ++i) {
    frames.push_back(i * kStep);
    camera_truth.push_back({i * kStep + 3000, at(0.1 * i)});
    if (i != 7) camera.push_back({i * kStep, at(5 + 0.1 * i + 0.001 * i)});
    if (i >= 12) object.push_back({i * kStep, at(object_truth[i].pose.t.x() + 5)});
  }
  const auto scores = scoreFrames(frames, {camera, camera_truth, at(-5), SE3()},
                                  {object, object_truth, at(-5), at(0.25)}, 1e-3);
  ASSERT_EQ(scores.size(), 30U);
  EXPECT_NEAR(*scores[20].camera_error, 0.020, 1e-9);
  EXPECT_FALSE(scores[7].camera_error);
  EXPECT_NEAR(*scores[12].object_error, 0.25, 1e-9);
  EXPECT_FALSE(scores[11].object_error);
  EXPECT_NEAR(*scores[15].object_speed, 0.2, 1e-9);
  EXPECT_NEAR(*scores[15].object_displacement, 0.06, 1e-9);
}

TEST(PerFrame, ShareCountsKnownPixelsAlone) {
  Image<std::uint8_t> mask(4, 1, 0);
  EXPECT_EQ(dynamicShare(mask), 0.0);
  mask(0, 0) = 1;
  mask(1, 0) = 2;
  mask(2, 0) = 3;
  EXPECT_NEAR(dynamicShare(mask), 1.0 / 3.0, 1e-12) << "the robot is known, but not dynamic";
}

TEST(PerFrame, CsvLeavesAbsentCellsEmpty) {
  FrameScore bare;
  bare.utime = 1'000'000'050'000;
  FrameScore full = bare;
  full.object_speed = 0.25;
  full.camera_error = 0.01;
  full.pixels = PixelCounts{6, 2, 3, 1};
  EXPECT_EQ(toCsv({bare, full}),
            "timestamp,object_speed_m_per_s,object_displacement_m,dynamic_share,camera_error_m,"
            "object_error_m,iou,static_accuracy,dynamic_accuracy,static_right,static_wrong,"
            "dynamic_right,dynamic_wrong\n"
            "1000000.050000,,,,,,,,,,,,\n"
            "1000000.050000,0.250000,,,0.010000,,0.500000,0.750000,0.750000,6,2,3,1\n");
}

}  // namespace
}  // namespace rf
