// SPDX-License-Identifier: BSD-3-Clause
// The robot's own pixels from the prior's shapes to segmentation, its labels, and fusion.
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "geometry/undistort.hpp"
#include "kinematics/self_filter.hpp"
#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_stage.hpp"
#include "pipeline/segmentation_stage.hpp"

namespace rf {
namespace {

/// A forearm across the lower part of the view, carried with the camera.
const Vec3 kHalf = {0.25, 0.06, 0.06};
const SE3 kT_CS = {Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vec3::UnitZ())), {0.05, 0.16, 0.65}};

Camera camera() { return test::testCamera(320, 240); }

SE3 cameraAt(int k) {
  Vec6 xi;
  xi << 0.01 * k, 0, 0.005 * k, 0, 0.01 * k, 0;
  return SE3(Eigen::Quaterniond::Identity(), {0, 0, -1.2}) * SE3::exp(xi);
}

RgbdFrame frameAt(int k) {
  test::Scene scene = test::room();
  scene.boxes.push_back(test::movingBox(cameraAt(k) * kT_CS, kHalf));
  return test::shoot(scene, cameraAt(k), camera(), {1.0, 3.0, 5}, k).frame;
}

MotionPrior priorOf(const RgbdFrame& frame, bool knows_itself) {
  MotionPrior prior;
  prior.utime_a = prior.utime_b = frame.utime;
  prior.seq = frame.seq;
  if (knows_itself) prior.self = {{RobotShapeKind::kBox, kHalf, kT_CS}};
  return prior;
}

/// True pixels of the forearm: nearer than anything of the room.
bool isArm(const RgbdFrame& frame, int u, int v) {
  return frame.depth_mm(u, v) != 0 && frame.depth_mm(u, v) < 800;
}

TEST(SelfStage, SegmentsAsIfTheRobotHadNoDepth) {
  SegmentationStage filtering({}, camera());
  SegmentationStage given({}, camera());
  for (int k = 0; k < 4; ++k) {
    const RgbdFrame frame = frameAt(k);
    const SegmentationResult out = filtering.process(frame, priorOf(frame, true), nullptr);
    RgbdFrame cleared = frame;
    const SelfMask self = SelfFilter({}, camera()).find(priorOf(frame, true).self, frame.depth_mm);
    for (std::size_t i = 0; i < self.mask.size(); ++i) {
      if (self.mask[i] != 0) cleared.depth_mm[i] = 0;
    }
    const SegmentationResult want = given.process(cleared, priorOf(frame, false), nullptr);
    EXPECT_EQ(out.camera.T_AB, want.camera.T_AB) << "frame " << k;
    EXPECT_EQ(out.gamma, want.gamma);
    int robot = 0;
    for (int v = 0; v < out.label.height(); ++v) {
      for (int u = 0; u < out.label.width(); ++u) {
        const bool arm = isArm(frame, 2 * u, 2 * v) || isArm(frame, 2 * u + 1, 2 * v) ||
                         isArm(frame, 2 * u, 2 * v + 1) || isArm(frame, 2 * u + 1, 2 * v + 1);
        if (out.label(u, v) == kSelfLabel) {
          EXPECT_EQ(out.score(u, v), 255);
          ++robot;
        } else {
          EXPECT_FALSE(arm) << u << " " << v;
          EXPECT_EQ(out.label(u, v), want.label(u, v));
          EXPECT_EQ(out.score(u, v), want.score(u, v));
        }
      }
    }
    EXPECT_GT(robot, 500);
    EXPECT_NEAR(out.self_share, self.pixels / (320.0 * 240.0), 0.01) << "all pixels have depth";
    EXPECT_EQ(out.self_behind, 0);
  }
}

TEST(SelfStage, WithoutShapesOrSwitchedOffNothingChanges) {
  SegmentationConfig off;
  off.self_filter.enabled = false;
  SegmentationStage with({}, camera());
  SegmentationStage without(off, camera());
  for (int k = 0; k < 3; ++k) {
    const RgbdFrame frame = frameAt(k);
    const SegmentationResult a = with.process(frame, priorOf(frame, false), nullptr);
    const SegmentationResult b = without.process(frame, priorOf(frame, true), nullptr);
    EXPECT_EQ(a.label, b.label);
    EXPECT_EQ(a.score, b.score);
    EXPECT_EQ(a.camera.T_AB, b.camera.T_AB);
    for (const std::uint8_t label : a.label) ASSERT_NE(label, kSelfLabel);
  }
}

TEST(SelfStage, SaysWhenTheRobotIsNotWhereItShouldBe) {
  SegmentationStage stage({}, camera());
  const RgbdFrame frame = frameAt(0);
  MotionPrior wrong = priorOf(frame, true);
  wrong.self[0].T_CS.t.y() -= 0.3;  // an arm that the picture does not show
  const SegmentationResult out = stage.process(frame, wrong, nullptr);
  EXPECT_GT(out.self_behind, 0.9);
  EXPECT_LT(out.self_share, 0.01);
}

TEST(SelfStage, FusionNeitherTracksNorFusesTheRobot) {
  const RgbdFrame frame = frameAt(0);
  SegmentationStage stage({}, camera());
  const SegmentationResult s = stage.process(frame, priorOf(frame, true), nullptr);
  const FusionConfig config;
  const FusionInput input = prepareFusionInput(frame, s, Undistorter(camera()), config);
  const int n = config.reduction;
  int room = 0;
  for (int v = 0; v < input.maps.depth.height(); ++v) {
    for (int u = 0; u < input.maps.depth.width(); ++u) {
      const float z = input.maps.depth(u, v);
      EXPECT_FALSE(z > 0 && z < 0.8F) << "the arm at " << u << " " << v;
      EXPECT_EQ(z, input.pyramid[0].depth(u, v));
      room += z > 0.8F ? 1 : 0;
    }
  }
  EXPECT_GT(room, 240 * 320 / (n * n) / 2) << "the rest is there";
}

TEST(SelfStage, TheMapHasNoRobot) {
  SegmentationStage stage({}, camera());
  FusionStage fusion({}, camera());
  std::optional<ModelState> state;
  for (int k = 0; k < 12; ++k) {
    const RgbdFrame frame = frameAt(k);
    state = fusion.process(frame,
                           stage.process(frame, priorOf(frame, true), state ? &*state : nullptr));
  }
  const std::vector<SurfelPoint> map = fusion.surfels(kBodyStatic);
  EXPECT_GT(map.size(), 1000U);
  for (const SurfelPoint& p : map) ASSERT_GT(p.z, 0.85F) << "the arm ends at 0.8 m";
  EXPECT_TRUE(fusion.surfels(kBodyObject).empty());
}

TEST(SelfStage, RefusesAShapeThatIsNoneAndKeepsItsState) {
  SegmentationStage stage({}, camera());
  const RgbdFrame frame = frameAt(0);
  MotionPrior bad = priorOf(frame, true);
  bad.self[0].T_CS.t.x() = std::nan("");
  EXPECT_THROW(stage.process(frame, bad, nullptr), std::invalid_argument);
  EXPECT_TRUE(stage.process(frame, priorOf(frame, true), nullptr).first);
}

}  // namespace
}  // namespace rf
