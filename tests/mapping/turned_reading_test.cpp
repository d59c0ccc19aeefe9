// SPDX-License-Identifier: BSD-3-Clause
// Mask and world the wrong way round from a body's birth on, until segmentation turns them.
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "pipeline/fusion_stage.hpp"

namespace rf {
namespace {

using test::cameraAt;
using test::Scene;
using test::Shot;

constexpr int kBorn = 4;
constexpr int kFrames = 24;
const Vec3 kHalf(0.8, 0.7, 0.25);

SE3 boxAt(int k) {
  const double s = 0.025 * std::max(0, k - (kBorn - 1));
  return SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3::UnitY())), Vec3(-0.3, 0.3, 0.8 - s));
}

void exchange(SegmentationResult& s) {
  for (std::size_t i = 0; i < s.score.size(); ++i) {
    const bool valid = s.label[i] == 1 || s.score[i] == 255;
    if (valid) s.score[i] = static_cast<std::uint8_t>(255 - s.score[i]);
  }
  s.gamma = {0.0F, 1.0F};
  s.dynamic_share = 1 - s.dynamic_share;
  std::swap(s.camera, s.object);
}

struct Outcome {
  std::vector<ModelState> states;
  std::vector<SurfelPoint> world, object;
};

// Segmentation reads it wrong in frames kBorn .. turn - 1 and says in frame `flagged` that it has
// turned.
Outcome run(int turn, int flagged) {
  const Camera camera = test::testCamera(320, 240);
  FusionStage stage(FusionConfig{}, camera);
  Outcome out;
  std::optional<Shot> previous;
  for (int k = 0; k < kFrames; ++k) {
    Scene scene = test::room();
    scene.boxes.push_back(test::movingBox(boxAt(k), kHalf));
    const Shot shot = test::shoot(scene, cameraAt(k), camera, {1.0, 3.0, 5}, k);
    const SE3 camera_step = k == 0 ? SE3() : cameraAt(k - 1).inverse() * cameraAt(k);
    const SE3 box_step =
        k == 0 ? SE3()
               : cameraAt(k - 1).inverse() * boxAt(k - 1) * boxAt(k).inverse() * cameraAt(k);
    SegmentationResult s =
        test::truth(shot, previous ? &*previous : nullptr, camera_step, box_step, k >= kBorn);
    if (k >= kBorn && k < turn) exchange(s);
    s.turned = k == flagged;
    out.states.push_back(stage.process(shot.frame, s));
    previous = shot;
  }
  out.world = stage.surfels(kBodyStatic);
  out.object = stage.surfels(kBodyObject);
  return out;
}

double cameraError(const Outcome& r, int k) {
  const SE3 truth = cameraAt(0).inverse() * cameraAt(k);
  return (r.states[static_cast<std::size_t>(k)].camera.T_W.t - truth.t).norm();
}

// Of the object's path since its birth.
double objectError(const Outcome& r, int k) {
  const auto truth = [](int i) { return cameraAt(0).inverse() * boxAt(i); };
  const auto pose = [&](int i) { return r.states[static_cast<std::size_t>(i)].object.T_W; };
  const SE3 offset = truth(kBorn).inverse() * pose(kBorn);
  return (pose(k).t - (truth(k) * offset).t).norm();
}

// Share of the surfels that lie on the box at T (box -> frame of the surfels).
double shareOnBox(const std::vector<SurfelPoint>& surfels, const SE3& T) {
  double on = 0;
  for (const SurfelPoint& p : surfels) {
    const Vec3 q = (T.inverse() * Vec3(p.x, p.y, p.z)).cwiseAbs() - kHalf;
    on += std::abs(q.maxCoeff()) < 0.03 ? 1.0 : 0.0;
  }
  return on / static_cast<double>(surfels.size());
}

TEST(TurnedReading, PutsCameraObjectAndModelsBack) {
  constexpr int kTurn = 14;
  const Outcome r = run(kTurn, kTurn);
  ASSERT_GT(cameraError(r, kTurn - 1), 0.15) << "the camera has gone with the box";
  for (int k = kTurn; k < kFrames; ++k) {
    EXPECT_LT(cameraError(r, k), 0.04) << k;  // what moved in the frame of the birth is 2.5 cm
    EXPECT_LT(objectError(r, k), 0.04) << k;
  }
  // The object's frame O has its place at the birth, which the camera's frame had there.
  const SE3 T_OB = cameraAt(kBorn).inverse() * boxAt(kBorn);
  EXPECT_GT(shareOnBox(r.object, T_OB), 0.8);
  const SE3 T_W0 = cameraAt(0).inverse();
  EXPECT_LT(shareOnBox(r.world, T_W0 * boxAt(kBorn)), 0.05);
  EXPECT_LT(shareOnBox(r.world, T_W0 * boxAt(kFrames - 1)), 0.05);
}

TEST(TurnedReading, IsNotTakenWhereTheModelsShowWhatTheMaskSays) {
  const Outcome plain = run(kBorn, -1);
  const Outcome flagged = run(kBorn, 14);
  for (int k = 0; k < kFrames; ++k) {
    EXPECT_EQ(flagged.states[static_cast<std::size_t>(k)].camera.T_W.t,
              plain.states[static_cast<std::size_t>(k)].camera.T_W.t);
  }
  EXPECT_LT(cameraError(flagged, kFrames - 1), 0.02);
}

}  // namespace
}  // namespace rf
