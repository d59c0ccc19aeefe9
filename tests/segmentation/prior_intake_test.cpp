// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/prior_intake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace rf {
namespace {

constexpr std::int64_t kFrame = 33333;  // microseconds

SE3 shifted(double x, double y, double z) { return {Mat3::Identity(), Vec3(x, y, z)}; }

/// Distance of two motions, metres and radians together.
double apart(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

const SE3 kObjectStart = shifted(0.2, 0.1, 2.0);  // T_CO, first frame
const SE3 kCameraStep = SE3::exp((Vec6() << .01, 0, .002, 0, .01, 0).finished());  // T_CaCb
const SE3 kObjectStep = SE3::exp((Vec6() << 0, 0, .012, .02, 0, 0).finished());    // T_OaOb

/// Prior of frame `n` of a camera and an object that move evenly.
MotionPrior priorOf(int n) {
  MotionPrior p;
  p.camera = PriorState::kValid;
  p.T_CaCb = kCameraStep;
  p.object = PriorState::kValid;
  p.object_kind = ObjectPriorKind::kWorldFrame;
  p.T_XOb = kObjectStart;
  for (int i = 0; i < n; ++i) {
    p.T_WCb = p.T_WCb * kCameraStep;
    p.T_XOa = p.T_XOb;
    p.T_XOb = p.T_XOb * kObjectStep;
  }
  p.camera_cov = p.object_cov = covarianceOf({0.002, 0.013});
  return p;
}

/// Three frames whose poses are the prior's.
struct Stream {
  explicit Stream(const SegmentationConfig& config = {}) : intake(config) {
    LastMotion last;
    for (int n = 0; n < 3; ++n) {
      PastFrame frame;
      frame.utime = n * kFrame;
      const MotionPrior prior = priorOf(n);
      if (n == 0) {
        intake.start(prior, frame);
      } else {
        intake.accept(prior, last, frame);
        frame.T_WC = frames.back().T_WC * frame.camera.T;
        frame.T_CO =
            frame.T_WC.inverse() * frames.back().T_WC * frames.back().T_CO * frame.object.T;
        last = {frame.camera.T, frame.object.T, frames.back().T_CO * frame.T_CO.inverse()};
      }
      frames.push_back(frame);
    }
  }
  std::deque<PastFrame> before() const { return {frames.begin(), frames.end() - 1}; }
  PriorIntake intake;
  std::deque<PastFrame> frames;
};

TEST(PriorIntake, StartsWhereTheSourcesSay) {
  const Stream s;
  EXPECT_TRUE(s.intake.objectSeen());
  EXPECT_LT(apart(s.frames[0].T_CO, kObjectStart), 1e-12);
}

/// The window's object motion after `frames` frames without an object prior, in each of which the
/// estimate follows what was expected and the models put it right; the first guess is 1 mm off.
double strayedAfter(int frames, bool learns) {
  Stream s;
  LastMotion last{kCameraStep, kObjectStep * shifted(0.001, 0, 0), std::nullopt};
  for (PastFrame& p : s.frames) p.object_confirmed = true;
  double off = 0;
  for (int n = 3; n < 3 + frames; ++n) {
    MotionPrior prior = priorOf(n);
    prior.object = PriorState::kMissing;
    PastFrame now;
    now.utime = n * kFrame;
    s.intake.accept(prior, last, now);
    PastFrame& ref = s.frames.front();
    const JointPrior window = s.intake.window(s.frames, ref, now);
    now.T_WC = ref.T_WC * window.T_s;
    now.T_CO = window.expectedObject(window.T_s).inverse() * ref.T_CO;
    const PastFrame& before = s.frames.back();
    const SE3 T_WO_before = before.T_WC * before.T_CO;
    last.object = T_WO_before.inverse() * now.T_WC * now.T_CO;
    const SE3 T_WO = T_WO_before * kObjectStep;
    off = (T_WO.t - now.T_WC * now.T_CO.t).norm();
    now.T_CO = now.T_WC.inverse() * T_WO;
    now.object_confirmed = true;
    if (learns && s.intake.learnObjectStep(before, now)) last.object = now.object.T;
    s.frames.push_back(now);
    s.frames.pop_front();
  }
  return off;
}

TEST(PriorIntake, WhatIsExpectedOfAnObjectWithoutAPriorDoesNotGrow) {
  EXPECT_GT(strayedAfter(10, false), 0.1) << "the case has something to mend";
  EXPECT_LT(strayedAfter(10, true), 1e-6);
}

TEST(PriorIntake, LearnsNoStepThatWasMeasuredOrIsNotConfirmed) {
  Stream s;
  PastFrame now = s.frames[2];
  now.T_CO = shifted(0.01, 0, 0) * now.T_CO;
  EXPECT_FALSE(s.intake.learnObjectStep(s.frames[1], now)) << "not confirmed";
  s.frames[1].object_confirmed = now.object_confirmed = true;
  EXPECT_FALSE(s.intake.learnObjectStep(s.frames[1], now)) << "measured";
  EXPECT_LT(apart(now.object.T, kObjectStep), 1e-12);
  now.object.measured = false;
  EXPECT_TRUE(s.intake.learnObjectStep(s.frames[1], now));
  EXPECT_GT(apart(now.object.T, kObjectStep), 0.005);
}

TEST(PriorIntake, LearnsTheCamerasStepFromConfirmedPosesWhereNothingMeasuredIt) {
  Stream s;
  PastFrame now = s.frames[2];
  now.T_WC = now.T_WC * shifted(0.01, 0, 0);
  EXPECT_FALSE(s.intake.learnCameraStep(s.frames[1], now)) << "not confirmed";
  s.frames[1].camera_confirmed = now.camera_confirmed = true;
  EXPECT_FALSE(s.intake.learnCameraStep(s.frames[1], now)) << "measured";
  now.camera.measured = false;
  EXPECT_TRUE(s.intake.learnCameraStep(s.frames[1], now));
  EXPECT_LT(apart(s.frames[1].T_WC * now.camera.T, now.T_WC), 1e-12);
}

TEST(PriorIntake, ChainsIncrementsOverTheWindow) {
  const Stream s;
  const JointPrior prior = s.intake.window(s.before(), s.frames[0], s.frames[2]);
  EXPECT_LT(apart(prior.T_s, kCameraStep * kCameraStep), 1e-12);
  const SE3 T_d = s.frames[0].T_CO * s.frames[2].T_CO.inverse();
  EXPECT_LT(prior.objectError(prior.T_s, T_d).norm(), 1e-9);
  // Drift adds linearly, turns in square.
  const Mat6 covariance = prior.information_s.inverse();
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), 2 * 0.002, 1e-5);
  EXPECT_NEAR(covariance(3, 3), 2 * 0.013 * 0.013, 1e-6);
}

TEST(PriorIntake, StepsFromTheEstimateWithOneIncrement) {
  Stream s;
  s.frames[1].T_WC = s.frames[1].T_WC * shifted(0.01, 0, 0);  // where the images saw it
  for (PastFrame& f : s.frames) f.anchored = true;
  const JointPrior prior = s.intake.step(s.frames[0], s.frames[1], s.frames[2]);
  EXPECT_LT(apart(prior.T_s, s.frames[0].T_WC.inverse() * s.frames[1].T_WC * kCameraStep), 1e-12);
  const double sure = prior.information_s(0, 0);
  s.frames[1].anchored = false;
  EXPECT_LT(s.intake.step(s.frames[0], s.frames[1], s.frames[2]).information_s(0, 0), sure);
}

TEST(PriorIntake, CannotPlaceAnObjectOfAnotherWorldWithoutACamera) {
  MotionPrior prior = priorOf(0);
  prior.camera = PriorState::kMissing;
  prior.T_XOb = shifted(0, 0, -3);  // behind the first view
  PriorIntake intake{SegmentationConfig{}};
  PastFrame frame;
  intake.start(prior, frame);
  EXPECT_FALSE(intake.objectSeen());
}

TEST(PriorIntake, LeavesTheObjectPriorOutWhenToldSo) {
  SegmentationConfig config;
  config.object_prior_use = "none";
  const Stream s(config);
  EXPECT_FALSE(s.intake.objectSeen());
  EXPECT_TRUE(s.intake.window(s.before(), s.frames[0], s.frames[2]).outlier_class);
  config.object_prior_use = "never";
  EXPECT_THROW(PriorIntake{config}, std::invalid_argument);
}

TEST(PriorIntake, MaturesAfterMovingFramesThatTheModelsConfirmed) {
  SegmentationConfig config;
  config.mature_frames = 2;
  Stream s(config);
  for (PastFrame& f : s.frames) f.camera_confirmed = f.object_confirmed = f.object_moves = true;
  s.intake.judge(s.frames[1], &s.frames[0]);
  EXPECT_FALSE(s.intake.mature());
  s.intake.judge(s.frames[2], &s.frames[1]);
  EXPECT_TRUE(s.intake.mature());
}

TEST(PriorIntake, ACameraPriorThatWasOffAtRestDoesNotTellWhichBodyIsTheWorld) {
  for (const bool object_prior : {false, true}) {
    SegmentationConfig config;
    if (!object_prior) config.object_prior_use = "none";
    PriorIntake intake(config);
    std::deque<PastFrame> frames;
    for (int n = 0; n < 14; ++n) {
      PastFrame frame;
      frame.utime = n * kFrame;
      n == 0 ? intake.start(priorOf(n), frame) : intake.accept(priorOf(n), LastMotion{}, frame);
      frame.T_WC = SE3();  // tracked: the camera rests
      frame.camera_confirmed = true;
      if (n == 1) {
        EXPECT_TRUE(intake.cameraTells(frame));
      }
      frames.push_back(frame);
      if (n > 0) intake.judge(frames[n], &frames[n - 1]);
    }
    EXPECT_EQ(intake.cameraTells(frames.back()), object_prior);
    frames.back().camera.measured = false;
    EXPECT_FALSE(intake.cameraTells(frames.back()));
  }
}

/// Frames of a tracked camera that follows `prior_until` frames of its prior and rests from then
/// on; a body moves from frame 14 on.
void judgeTracked(PriorIntake& intake, int prior_until, int count) {
  std::deque<PastFrame> frames;
  for (int n = 0; n < count; ++n) {
    PastFrame frame;
    frame.utime = n * kFrame;
    n == 0 ? intake.start(priorOf(n), frame) : intake.accept(priorOf(n), LastMotion{}, frame);
    frame.T_WC = priorOf(std::min(n, prior_until)).T_WCb;
    frame.camera_confirmed = frame.object_confirmed = true;
    frame.object_moves = n >= 14;
    frames.push_back(frame);
    if (n > 0) intake.judge(frames[n], &frames[n - 1]);
  }
}

TEST(PriorIntake, ACameraPriorThatWasRightAtRestKeepsTheModelsFromTheirVote) {
  SegmentationConfig config;
  config.mature_frames = 20;
  PriorIntake intake(config);
  judgeTracked(intake, 14, 80);  // off from the body's start on: either of the two is wrong
  EXPECT_FALSE(intake.mature());
}

TEST(PriorIntake, ACameraPriorThatWasOffAtRestDoesNotKeepTheModelsFromTheirVote) {
  SegmentationConfig config;
  config.mature_frames = 20;
  PriorIntake intake(config);
  judgeTracked(intake, 0, 34);
  EXPECT_TRUE(intake.mature());
}

}  // namespace
}  // namespace rf
