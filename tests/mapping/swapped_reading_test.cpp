// SPDX-License-Identifier: BSD-3-Clause
// A camera beside a body that fills most of the view: where no good prior tells which of both
// moves, the poses have to say so.
#include "pipeline/swapped_reading.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr double kStep = 0.02;  // metres that the body moves in each frame

SE3 shifted(double x) {
  SE3 out;
  out.t.x() = x;
  return out;
}

SE3 moved(int frames) { return shifted(kStep * frames); }

BodyPose tracked(const SE3& T_W) {
  BodyPose pose;
  pose.T_W = T_W;
  pose.covariance = Mat6::Identity() * 1e-6;
  pose.health = Health::kTracked;
  return pose;
}

enum class Prior : std::uint8_t { kNone, kCamera, kBoth };

// A camera at rest that sees a body move. `drift`: of the camera prior in each frame, metres.
struct Scene {
  SwappedReading reading;
  double dynamic_share = 0.6;
  Prior prior = Prior::kNone;
  double drift = 0;
  SE3 T_WC;
  int frame = 0;

  void see(const std::optional<SE3>& T_WO, bool moving = true, bool born = false) {
    SegmentationResult s;
    s.utime = 100'000 * frame;
    s.object_moving = moving;
    s.dynamic_share = moving ? dynamic_share : 0;
    s.has_prior_T_WC = prior != Prior::kNone;
    s.has_T_CO = prior == Prior::kBoth;
    s.prior_T_WC = shifted(drift * frame);
    reading.observe(s, {T_WC, T_WO, born || frame == 0});
    ++frame;
  }
  void move(int frames) {
    for (int i = 0; i < frames; ++i) see(moved(frame));
  }
  Health health() const { return reading.widened(tracked({})).health; }
  double variance() const { return reading.widened(tracked({})).covariance(0, 0); }
};

TEST(SwappedReading, DegradesBothPosesOnceTheBodyHasMovedFar) {
  Scene scene;
  scene.move(2);
  EXPECT_EQ(scene.health(), Health::kTracked);  // 2 cm
  scene.move(9);                                // 20 cm
  for (const SE3& T_W : {SE3(), moved(10)}) {
    const BodyPose pose = scene.reading.widened(tracked(T_W));
    EXPECT_EQ(pose.health, Health::kDegraded);
    EXPECT_NEAR(pose.covariance(0, 0), 0.2 * 0.2, 1e-5);
    EXPECT_NEAR(pose.covariance(3, 3), 0, 1e-5);
  }
}

TEST(SwappedReading, IsImpossibleWithBothPriorsOrASmallBody) {
  Scene told;
  told.prior = Prior::kBoth;
  told.drift = kStep;
  told.move(30);
  EXPECT_EQ(told.health(), Health::kTracked);
  Scene small;
  small.dynamic_share = 0.4;
  small.move(30);
  EXPECT_EQ(small.health(), Health::kTracked);
}

TEST(SwappedReading, StaysWhenTheBodyGrowsLaterRestsGoesOrIsBornAgain) {
  Scene scene;
  scene.dynamic_share = 0.4;
  scene.move(11);
  scene.dynamic_share = 0.6;
  scene.move(1);
  scene.see(moved(11), false);
  scene.see(std::nullopt, false);
  EXPECT_NEAR(scene.variance(), 0.22 * 0.22, 1e-5);
  scene.dynamic_share = 0.1;
  scene.see(SE3(), true, true);  // another model: its place is no motion
  EXPECT_NEAR(scene.variance(), 0.22 * 0.22, 1e-5);
}

TEST(SwappedReading, StaysWhenTheBodyIsBack) {
  // half of the way there may have been the camera's
  Scene scene;
  scene.move(30);
  for (int i = 29; i >= 0; --i) scene.see(moved(i));
  for (int i = 0; i < 12; ++i) scene.see(SE3(), false);
  EXPECT_NEAR(scene.variance(), 0.58 * 0.58, 1e-5);
}

TEST(SwappedReading, AGoodCameraPriorEndsItWithinASecond) {
  Scene scene;
  scene.prior = Prior::kCamera;
  scene.drift = 0.25 * kStep;
  scene.move(10);  // 18 cm in 0.9 s: no window is whole yet
  EXPECT_EQ(scene.health(), Health::kDegraded);
  scene.move(1);
  EXPECT_EQ(scene.health(), Health::kTracked);
  scene.move(30);
  EXPECT_EQ(scene.health(), Health::kTracked);
  EXPECT_LT(scene.variance(), 1e-5);
}

TEST(SwappedReading, StaysWithACameraPriorThatFitsTheOtherReadingAsWell) {
  // the other reading moves the camera by -kStep in each frame
  for (const double drift : {-kStep, -0.5 * kStep, 2 * kStep}) {
    Scene scene;
    scene.prior = Prior::kCamera;
    scene.drift = drift;
    scene.move(41);
    EXPECT_EQ(scene.health(), Health::kDegraded) << drift;
    EXPECT_NEAR(scene.variance(), 0.8 * 0.8, 1e-4) << drift;
    // what was in doubt for a second stays so, although the prior is good from now on
    scene.drift = 0;
    scene.move(30);
    EXPECT_EQ(scene.health(), Health::kDegraded) << drift;
  }
}

TEST(SwappedReading, CountsMotionWhileTheCameraPriorIsSilent) {
  Scene scene;
  scene.prior = Prior::kCamera;
  scene.move(12);
  scene.prior = Prior::kNone;
  scene.move(20);
  EXPECT_NEAR(scene.variance(), 0.4 * 0.4, 1e-4);
}

TEST(SwappedReading, ATurnMakesTheOtherReadingOurs) {
  Scene scene;
  scene.prior = Prior::kCamera;
  scene.drift = -kStep;  // it is the camera that moves
  scene.move(9);
  ASSERT_EQ(scene.health(), Health::kDegraded);
  const SE3 T_WW = shifted(-kStep * (scene.frame - 1));
  scene.reading.turn(T_WW, T_WW);
  EXPECT_EQ(scene.reading.widened(tracked(T_WW)).health, Health::kDegraded) << "not a second yet";
  for (int i = 0; i < 2; ++i) {
    scene.T_WC = shifted(-kStep * scene.frame);
    scene.see(scene.T_WC);
  }
  EXPECT_EQ(scene.reading.widened(tracked(scene.T_WC)).health, Health::kTracked)
      << "all of the second fits, also before the turn";
}

}  // namespace
}  // namespace rf
