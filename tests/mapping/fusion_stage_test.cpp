// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/fusion_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "geometry/parallel.hpp"

namespace rf {
namespace {

using test::Scene;
using test::SceneBox;
using test::Shot;

Vec6 twist(double x, double y, double z, double a, double b, double c) {
  Vec6 t;
  t << x, y, z, a, b, c;
  return t;
}

// The camera looks along +z and sways through the room.
SE3 cameraAt(int k) {
  const double s = 0.04 * k;
  return SE3::exp(twist(0.35 * std::sin(s), 0.08 * std::sin(0.7 * s), -1.2 + 0.15 * s,
                        0.04 * std::sin(1.3 * s), 0.25 * std::sin(0.8 * s), 0.03 * std::sin(s)));
}

// A deterministic disturbance of 2 mm and 13 mrad.
SE3 drift(int k) {
  const double a = 2.399963 * k;
  return SE3::exp(twist(0.002 * std::sin(a), 0.002 * std::cos(1.7 * a), 0.001,
                        0.010 * std::cos(1.3 * a), 0.010 * std::sin(0.9 * a),
                        0.006 * std::sin(2.1 * a)));
}

TEST(FusionStage, CorrectsDriftingPriorsInAStaticRoom) {
  const Camera camera = test::testCamera(640, 480);
  const Scene scene = test::room();
  FusionStage stage(FusionConfig{}, camera);
  std::optional<Shot> previous;
  double worst = 0;
  SE3 prior;
  for (int k = 0; k < 30; ++k) {
    const Shot shot = test::shoot(scene, cameraAt(k), camera, {1.0, 3.0, 5}, k);
    const SE3 motion = k == 0 ? SE3() : cameraAt(k - 1).inverse() * cameraAt(k) * drift(k);
    prior = prior * motion;
    const ModelState state = stage.process(
        shot.frame, test::truth(shot, previous ? &*previous : nullptr, motion, motion, false));
    const SE3 error = (cameraAt(0).inverse() * cameraAt(k)).inverse() * state.camera.T_W;
    worst = std::max(worst, error.t.norm());
    EXPECT_EQ(state.camera.health, Health::kTracked) << "frame " << k;
    previous = shot;
  }
  EXPECT_LT(worst, 0.006);
}

// A box that rests, moves, rests and moves on, seen by a swaying camera; half-size input for speed.
struct BoxRun {
  static constexpr int kMove = 8, kRest = 24, kAgain = 34, kEnd = 42;
  Camera camera = test::testCamera(320, 240);
  std::vector<ModelState> states;
  std::vector<SurfelPoint> world, object;

  static bool moves(int k) { return (k > kMove && k <= kRest) || k > kAgain; }
  static SE3 boxAt(int k) {
    const double s = 0.02 * (std::clamp(k - kMove, 0, kRest - kMove) + std::max(k - kAgain, 0));
    return SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.5 + 0.6 * s, Vec3::UnitY())),
               Vec3(-0.3 + s, 0.3, 0.5));
  }
  static SE3 objectMotion(int k) {
    const SE3 a = cameraAt(k - 1).inverse() * boxAt(k - 1);
    const SE3 b = cameraAt(k).inverse() * boxAt(k);
    return a * b.inverse();
  }

  void run(int frames = kEnd) {
    FusionStage stage(FusionConfig{}, camera);
    std::optional<Shot> previous;
    for (int k = 0; k < frames; ++k) {
      Scene scene = test::room();
      scene.boxes.push_back(test::movingBox(boxAt(k), Vec3(0.3, 0.4, 0.25)));
      const Shot shot = test::shoot(scene, cameraAt(k), camera, {1.0, 3.0, 5}, k);
      const SE3 motion = k == 0 ? SE3() : cameraAt(k - 1).inverse() * cameraAt(k) * drift(k);
      const SE3 object_step = moves(k) ? objectMotion(k) * drift(k + 50) : motion;
      states.push_back(stage.process(shot.frame, test::truth(shot, previous ? &*previous : nullptr,
                                                             motion, object_step, moves(k))));
      previous = shot;
    }
    world = stage.surfels(kBodyStatic);
    object = stage.surfels(kBodyObject);
  }
};

TEST(FusionStage, FollowsABoxThatRestsAndMovesOn) {
  BoxRun r;
  r.run();
  const SE3 to_first = cameraAt(0).inverse();
  const int birth = BoxRun::kMove + 1;
  const SE3 offset = (to_first * BoxRun::boxAt(birth)).inverse() * r.states[birth].object.T_W;
  for (int k = 0; k < BoxRun::kEnd; ++k) {
    const ModelState& s = r.states[static_cast<std::size_t>(k)];
    EXPECT_EQ(s.object_exists, k >= birth) << k;
    EXPECT_EQ(s.object_resting, k >= birth && !BoxRun::moves(k)) << k;
    EXPECT_LT(((to_first * cameraAt(k)).inverse() * s.camera.T_W).t.norm(), 0.012) << k;
    if (!s.object_exists) continue;
    const SE3 error = (to_first * BoxRun::boxAt(k) * offset).inverse() * s.object.T_W;
    EXPECT_LT(error.t.norm(), 0.03) << k;
    EXPECT_LT(error.log().tail<3>().norm(), 0.03) << k;
    EXPECT_TRUE(s.object.covariance.allFinite());
    if (s.object_resting && r.states[static_cast<std::size_t>(k - 1)].object_resting) {
      EXPECT_EQ(s.object.T_W, r.states[static_cast<std::size_t>(k - 1)].object.T_W)
          << "rests: constant";
    }
  }
  EXPECT_EQ(r.states.back().object.health, Health::kTracked);

  // The object model lies on the box; the static map has nothing where the box has been.
  int off_box = 0, ghosts = 0;
  for (const SurfelPoint& p : r.object) {
    const Vec3 q = (offset * Vec3(p.x, p.y, p.z)).cwiseAbs() - Vec3(0.3, 0.4, 0.25);
    off_box += std::max(std::abs(q.maxCoeff()), q.cwiseMax(0).norm()) > 0.03 ? 1 : 0;
  }
  EXPECT_GT(r.object.size(), 500U);
  EXPECT_LT(off_box, static_cast<int>(r.object.size() / 20));
  for (const SurfelPoint& p : r.world) {
    const Vec3 p_W = cameraAt(0) * Vec3(p.x, p.y, p.z);
    const auto in = [&](int k, double margin) {
      const Vec3 q = (BoxRun::boxAt(k).inverse() * p_W).cwiseAbs() - Vec3(0.3, 0.4, 0.25);
      return q.maxCoeff() < margin;
    };
    // What is out of view or hidden by the box cannot be known to be free.
    const Vec3 p_C = cameraAt(BoxRun::kEnd - 1).inverse() * p_W;
    const Eigen::Vector2d px = r.camera.project(p_C);
    const bool in_view = p_C.z() > 0.3 && px.x() > 8 && px.y() > 8 && px.x() < 312 && px.y() < 232;
    ghosts += in_view && in(0, 0.01) && !in(BoxRun::kEnd - 1, 0.05) ? 1 : 0;
  }
  EXPECT_LT(ghosts, 40);
}

TEST(FusionStage, SaysWhichBodyIsInFront) {
  BoxRun r;
  r.run(BoxRun::kRest + 4);
  const ModelState& s = r.states.back();
  ASSERT_TRUE(s.object_resting);
  EXPECT_EQ(s.predicted_depth_mm.width(), 80);
  EXPECT_EQ(s.body.height(), 60);
  int object = 0, world = 0;
  for (std::size_t i = 0; i < s.body.size(); ++i) {
    object += s.body[i] == kBodyObject ? 1 : 0;
    world += s.body[i] == kBodyStatic ? 1 : 0;
    EXPECT_EQ(s.body[i] == kBodyNone, s.predicted_depth_mm[i] == 0);
  }
  EXPECT_GT(object, 150);
  EXPECT_GT(world, 2500);
}

void expectSame(const ModelState& a, const ModelState& b) {
  EXPECT_EQ(a.camera.T_W, b.camera.T_W);
  EXPECT_EQ(a.camera.covariance, b.camera.covariance);
  EXPECT_EQ(a.camera.rms_residual, b.camera.rms_residual);
  EXPECT_EQ(a.object.T_W, b.object.T_W);
  EXPECT_EQ(a.static_surfels, b.static_surfels);
  EXPECT_EQ(a.object_surfels, b.object_surfels);
  EXPECT_EQ(a.predicted_depth_mm, b.predicted_depth_mm);
  EXPECT_EQ(a.body, b.body);
}

TEST(FusionStage, GivesTheSameBytesForOneAndTwoThreads) {
  BoxRun one, two;
  setThreads(1);
  one.run(20);
  setThreads(2);
  two.run(20);
  setThreads(1);
  for (std::size_t k = 0; k < one.states.size(); ++k) expectSame(one.states[k], two.states[k]);
  ASSERT_EQ(one.world.size(), two.world.size());
  for (std::size_t i = 0; i < one.world.size(); ++i) {
    ASSERT_EQ(one.world[i].x, two.world[i].x);
    ASSERT_EQ(one.world[i].confidence, two.world[i].confidence);
  }
  EXPECT_EQ(one.object.size(), two.object.size());
}

TEST(FusionStage, StartsAtThePriorsPoseAndBridgesALostFrame) {
  const Camera camera = test::testCamera(320, 240);
  const SE3 T_W0(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3::UnitZ())), Vec3(3, -2, 1));
  FusionStage stage(FusionConfig{}, camera);
  std::optional<Shot> previous, dropped;
  ModelState state;
  for (int k = 0; k < 12; ++k) {
    const Shot shot = test::shoot(test::room(), cameraAt(k), camera, {1.0, 3.0, 5}, k);
    const SE3 motion = k == 0 ? SE3() : cameraAt(k - 1).inverse() * cameraAt(k);
    SegmentationResult s =
        test::truth(shot, previous ? &*previous : nullptr, motion, motion, false);
    s.has_prior_T_WC = k == 0;
    s.prior_T_WC = T_W0;
    previous = shot;
    if (k == 8) continue;  // fusion never sees this frame; segmentation did
    state = stage.process(shot.frame, s);
    EXPECT_LT(((T_W0 * cameraAt(0).inverse() * cameraAt(k)).inverse() * state.camera.T_W).t.norm(),
              0.012)
        << k;
    EXPECT_EQ(state.camera.health, k == 9 ? Health::kDegraded : Health::kTracked) << k;
  }
  stage.reset();
  EXPECT_TRUE(stage.surfels(kBodyStatic).empty());
}

TEST(FusionStage, RefusesBrokenInputAndGoesOn) {
  const Camera camera = test::testCamera(320, 240);
  FusionStage stage(FusionConfig{}, camera);
  const Shot shot = test::shoot(test::room(), cameraAt(0), camera, {}, 0);
  const SegmentationResult good = test::truth(shot, nullptr, SE3(), SE3(), false);
  const auto refused = [&](const RgbdFrame& f, const SegmentationResult& s,
                           const std::string& word) {
    try {
      stage.process(f, s);
      ADD_FAILURE() << word << " was accepted";
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
    }
  };
  SegmentationResult s = good;
  s.utime += 1;
  refused(shot.frame, s, "utime");
  s = good;
  s.score = Image<std::uint8_t>(10, 10);
  refused(shot.frame, s, "segmentation.score is 10x10, must be 160x120");
  s = good;
  s.reduction = 0;
  refused(shot.frame, s, "reduction");
  s = good;
  s.camera.T_AB.t.x() = std::numeric_limits<double>::quiet_NaN();
  refused(shot.frame, s, "camera.T_AB");
  s = good;
  s.has_T_CO = true;
  s.T_CO.q.w() = std::numeric_limits<double>::infinity();
  refused(shot.frame, s, "T_CO");
  RgbdFrame small = shot.frame;
  small.depth_mm = Image<std::uint16_t>(16, 16);
  refused(small, good, "depth_mm");
  EXPECT_TRUE(stage.surfels(kBodyStatic).empty());

  s = good;
  s.camera.covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(stage.process(shot.frame, s).camera.health, Health::kTracked);
  Camera broken = camera;
  broken.fx = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(FusionStage(FusionConfig{}, broken), std::invalid_argument);
  FusionConfig config;
  config.tracking.kernel = "none";
  EXPECT_THROW(FusionStage(config, camera), std::invalid_argument);
}

TEST(FusionStage, IsHonestWhenTheImageGivesNothing) {
  const Camera camera = test::testCamera(320, 240);
  FusionStage stage(FusionConfig{}, camera);
  std::optional<Shot> previous;
  for (int k = 0; k < 6; ++k) {
    Shot shot = test::shoot(test::room(), cameraAt(k), camera, {1.0, 3.0, 5}, k);
    const bool blind = k >= 4;
    if (blind) std::fill(shot.frame.depth_mm.begin(), shot.frame.depth_mm.end(), std::uint16_t{0});
    const SE3 motion = k == 0 ? SE3() : cameraAt(k - 1).inverse() * cameraAt(k);
    SegmentationResult s =
        test::truth(shot, previous ? &*previous : nullptr, motion, motion, false);
    if (blind) s.camera.health = Health::kPriorOnly;
    const ModelState state = stage.process(shot.frame, s);
    EXPECT_EQ(state.camera.health, blind ? Health::kPriorOnly : Health::kTracked) << k;
    EXPECT_TRUE(state.camera.covariance.allFinite());
    previous = shot;
  }
}

}  // namespace
}  // namespace rf
