// SPDX-License-Identifier: BSD-3-Clause
// An object that rests, is not seen, comes back or stays for good, as fusion sees it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "pipeline/fusion_stage.hpp"

namespace rf {
namespace {

using test::cameraAt;
using test::Scene;
using test::Shot;

const Vec3 kHalf(0.3, 0.4, 0.25);

struct Script {
  int begin = 4;               // first frame in which the box has moved
  int end = 14;                // last one
  int unseen_from = 1 << 20;   // frames in which segmentation sees no box and has a prior alone
  int unseen_until = 1 << 20;  // (one past)
  SE3 drift;                   // of that prior, per frame
  bool born_small = false;     // the first mask holds the box's left end alone
  bool prior = true;           // else its motion is taken for the world's
  int leaps_at = 1 << 20;      // frame in which segmentation finds it half a metre away
};

SE3 boxAt(const Script& script, int k) {
  const double s = 0.025 * (std::clamp(k, script.begin - 1, script.end) - (script.begin - 1));
  return SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.5 + 0.5 * s, Vec3::UnitY())),
             Vec3(-0.25 + s, 0.3, 0.5));
}

struct Outcome {
  std::vector<ModelState> states;
  std::vector<SurfelPoint> world, object;
};

// Keeps the mask in the left fifth of the image.
void keepLeft(SegmentationResult& s) {
  for (int v = 0; v < s.score.height(); ++v) {
    for (int u = s.score.width() / 5; u < s.score.width(); ++u) s.score(u, v) = 255;
  }
}

Outcome run(const Script& script, int frames, const FusionConfig& config = {}) {
  const Camera camera = test::testCamera(320, 240);
  FusionStage stage(config, camera);
  Outcome out;
  std::optional<Shot> previous;
  for (int k = 0; k < frames; ++k) {
    Scene scene = test::room();
    scene.boxes.push_back(test::movingBox(boxAt(script, k), kHalf));
    const Shot shot = test::shoot(scene, cameraAt(k), camera, {1.0, 3.0, 5}, k);
    const SE3 camera_step = k == 0 ? SE3() : cameraAt(k - 1).inverse() * cameraAt(k);
    const SE3 box_step = k == 0 ? SE3()
                                : cameraAt(k - 1).inverse() * boxAt(script, k - 1) *
                                      boxAt(script, k).inverse() * cameraAt(k);
    const bool unseen = k >= script.unseen_from && k < script.unseen_until;
    const bool moves = k >= script.begin && k <= script.end;
    SegmentationResult s =
        test::truth(shot, previous ? &*previous : nullptr, camera_step,
                    unseen ? box_step * script.drift : box_step, moves && !unseen);
    if (script.born_small && k == script.begin) keepLeft(s);
    if (k == script.leaps_at)
      s.object.T_AB = s.object.T_AB * SE3(Mat3::Identity(), Vec3(0.5, 0, 0));
    if (unseen) {
      s.object.T_AB = script.prior ? box_step * script.drift : camera_step;
      s.object.health = script.prior ? Health::kPriorOnly : Health::kLost;
      s.object_moving = !script.prior;
    }
    out.states.push_back(stage.process(shot.frame, s));
    previous = shot;
  }
  out.world = stage.surfels(kBodyStatic);
  out.object = stage.surfels(kBodyObject);
  return out;
}

// Surfels of the static map on the box as it stood in frame k.
int onBox(const std::vector<SurfelPoint>& world, const Script& script, int k) {
  int n = 0;
  for (const SurfelPoint& p : world) {
    const Vec3 p_B = boxAt(script, k).inverse() * cameraAt(0) * Vec3(p.x, p.y, p.z);
    const Vec3 q = p_B.cwiseAbs() - kHalf;
    const bool on_side = std::abs(q.maxCoeff()) < 0.015 && p_B.y() < 0.9 * kHalf.y();
    n += on_side ? 1 : 0;
  }
  return n;
}

double positionError(const Outcome& r, const Script& script, int k) {
  const auto pose = [&](int i) { return r.states[static_cast<std::size_t>(i)].object.T_W; };
  const SE3 offset =
      (cameraAt(0).inverse() * boxAt(script, script.begin)).inverse() * pose(script.begin);
  return (pose(k).t - (cameraAt(0).inverse() * boxAt(script, k) * offset).t).norm();
}

TEST(StateChanges, TheMapForgetsABodyThatTurnsOutToMoveAlsoWhereNothingIsSeenBehindIt) {
  Script script;
  script.end = 9;  // 15 cm: most of what it hid is still hidden
  FusionConfig on;
  on.surfels.export_remnants = true;
  FusionConfig off = on;
  off.object.shared_m = off.object.onset_m = 0;
  const int without = onBox(run(script, 20, off).world, script, 0);
  const int with = onBox(run(script, 20, on).world, script, 0);
  EXPECT_GT(without, 300) << "the case has something to remove";
  EXPECT_LT(with, without / 20);
  off.surfels.export_remnants = false;
  EXPECT_LT(onBox(run(script, 20, off).world, script, 0), without / 20)
      << "what is left of it is not saved, either";
}

TEST(StateChanges, AnUnseenBodyFollowsItsPriorAndIsFoundByItsModel) {
  Script script;
  script.unseen_from = 10;
  script.unseen_until = 13;
  const Outcome r = run(script, 20);
  for (int k = script.unseen_from; k < script.unseen_until; ++k) {
    const ModelState& s = r.states[static_cast<std::size_t>(k)];
    EXPECT_TRUE(s.object_exists);
    EXPECT_FALSE(s.object_resting);
    EXPECT_EQ(s.object.health, Health::kTracked) << k << ": its model fits without a mask";
    EXPECT_LT(positionError(r, script, k), 0.02) << k;
  }
  EXPECT_LT(positionError(r, script, 19), 0.02);
  EXPECT_LT(onBox(r.world, script, 19), 40) << "the static map does not take it";
}

TEST(StateChanges, ABodyAtRestIsKeptInPlaceWhenItsPriorSlips) {
  Script script;
  script.unseen_from = 18;
  script.unseen_until = 24;
  script.drift.t = Vec3(0.004, 0, -0.003);  // 15 cm/s at 30 Hz
  const Outcome r = run(script, 28);
  EXPECT_LT(positionError(r, script, 23), 0.02);
  EXPECT_TRUE(r.states.back().object_resting);
  EXPECT_LT(onBox(r.world, script, 27), 40);
}

TEST(StateChanges, WithoutAPriorAnUnseenBodyKeepsItsModelAndIsFoundWhereItIs) {
  Script script;
  script.prior = false;
  script.unseen_from = 9;
  script.unseen_until = 12;
  const Outcome r = run(script, 16);
  const std::int64_t before = r.states[8].object_surfels;
  EXPECT_GT(before, 1000);
  for (int k = script.unseen_from; k < script.unseen_until; ++k) {
    const ModelState& s = r.states[static_cast<std::size_t>(k)];
    EXPECT_EQ(s.object_surfels, before) << k << ": neither grown nor carved";
    EXPECT_EQ(s.object.health, Health::kTracked) << k;
    EXPECT_LT(positionError(r, script, k), 0.02) << k;
  }
}

TEST(StateChanges, ABodyThatSegmentationMakesLeapStaysInMotion) {
  Script script;
  script.leaps_at = 10;
  const Outcome r = run(script, 18);
  for (int k = script.leaps_at; k < 18; ++k) {
    EXPECT_LT(positionError(r, script, k), 0.02) << k;
    EXPECT_EQ(r.states[static_cast<std::size_t>(k)].object.health, Health::kTracked) << k;
  }
}

TEST(StateChanges, AModelThatWasBornTooSmallGrowsOn) {
  Script script;
  script.unseen_from = 5;  // right after a birth from a few pixels
  script.unseen_until = 6;
  script.born_small = true;
  const Outcome r = run(script, 16);
  EXPECT_LT(r.states[4].object_surfels, 500) << "too few to be tracked";
  EXPECT_GT(r.states[14].object_surfels, 1000);
}

TEST(StateChanges, AfterItsTimeABodyAtRestJoinsTheMap) {
  Script script;
  FusionConfig config;
  config.object.join_after_s = 0.2;
  const Outcome r = run(script, 30, config);
  EXPECT_TRUE(r.states[16].object_exists);
  EXPECT_FALSE(r.states.back().object_exists);
  EXPECT_TRUE(r.object.empty());
  EXPECT_GT(onBox(r.world, script, 29), 1000);
  const Outcome never = run(script, 30);
  EXPECT_TRUE(never.states.back().object_resting);
  EXPECT_LT(onBox(never.world, script, 29), 40);
}

}  // namespace
}  // namespace rf
