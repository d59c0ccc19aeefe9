// SPDX-License-Identifier: BSD-3-Clause
// A body that no object prior announced: mask and world are not swapped, whether the camera prior
// can tell which of two motions is the world's or not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geometry/parallel.hpp"
#include "priors/simulated_drift.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 20;  // the objects start about frame 33
constexpr int kFrames = 60;

void expectRight(const SimulatedCut& cut, const SequenceRun& out) {
  const TrajectoryScore camera = scoreCamera(out.camera, cut.camera, out.frames);
  EXPECT_LT(100 * camera.ate_first.rmse, 3.0);
  std::vector<PixelCounts> counts;
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    if (cut.speed[k] > 0.15) counts.push_back(countPixels(cut.truth[k], out.masks[k]));
  }
  ASSERT_GT(counts.size(), 15U);
  EXPECT_GT(scoreSegmentation(counts, 0).iou, 0.8);
}

/// A cut of a scene without an object prior, and with camera priors of some drift, or none.
class WhichWorld : public ::testing::Test {
 protected:
  void SetUp() override { setThreads(2); }
  void TearDown() override { setThreads(1); }

  void run(const std::string& scene, std::uint64_t seed,
           const std::vector<std::optional<DriftSpec>>& camera_priors) {
    const sim::Simulator simulator(scene, seed);
    const SimulatedCut cut = renderCut(simulator, kFirst, kFrames, seed);
    const PipelineConfig config;
    for (const auto& drift : camera_priors) {
      SCOPED_TRACE(drift ? "camera prior, m/s: " + std::to_string(drift->translation_mps)
                         : "no camera prior");
      PriorStage prior(config.prior);
      if (drift) prior.addCameraPoses(withDrift(cut.camera, *drift));
      expectRight(cut, runSequence(simulator.world().camera, config, prior, framesOf(cut)));
    }
  }
};

TEST_F(WhichWorld, IsTheLargerPartOfTheViewWhereNoPriorTells) {
  run("sideway", 41, {std::nullopt, DriftSpec{0.34, 1.2, 41}});
}

// Two fifths of the view, and the richer texture: the nearer side of its border.
TEST_F(WhichWorld, IsBehindTheBodyWhereNoPriorTells) { run("overtake", 42, {std::nullopt}); }

// It goes with the body by half a metre until mask and world are turned.
TEST_F(WhichWorld, HasTheCameraBackWhereItWasReadWrong) {
  const sim::Simulator simulator("overtake", 3);
  const SimulatedCut cut = renderCut(simulator, 0, 70, 3);
  PipelineConfig config;
  config.segmentation.decision.body_behind_charge = 0;  // else it is read right at once
  PriorStage prior(config.prior);
  prior.addCameraPoses(withDrift(cut.camera, {0.12, 0.8, 3}));
  const SequenceRun out = runSequence(simulator.world().camera, config, prior, framesOf(cut));
  ASSERT_EQ(out.camera.size(), cut.camera.size());
  const auto error = [&](std::size_t k) {
    const SE3 offset = cut.camera[0].pose * out.camera[0].pose.inverse();
    return (offset * out.camera[k].pose.t - cut.camera[k].pose.t).norm();
  };
  double largest = 0;
  for (std::size_t k = 0; k < out.camera.size(); ++k) largest = std::max(largest, error(k));
  EXPECT_GT(largest, 0.2) << "the case has something to mend";
  EXPECT_LT(error(out.camera.size() - 1), 0.06);
}

/// The camera poses of a cut, but from frame `first` on, for `count` frames, odometry goes as if
/// the body were the world.
Trajectory goingWithTheBody(const SimulatedCut& cut, std::size_t first, std::size_t count) {
  Trajectory out = cut.camera;
  for (std::size_t k = 1; k < out.size(); ++k) {
    const auto relative = [&](std::size_t i) {
      return cut.camera[i].pose.inverse() * cut.object[i].pose;  // T_CO
    };
    const bool lies = k >= first && k < first + count;
    const SE3 step = lies ? relative(k - 1) * relative(k).inverse()
                          : cut.camera[k - 1].pose.inverse() * cut.camera[k].pose;
    out[k].pose = out[k - 1].pose * step;
  }
  return out;
}

// Three fifths of the view are the body's when odometry goes with it for three frames: whatever its
// share, a world that has lasted is not given up for a moment.
TEST_F(WhichWorld, IsNotTurnedByAMoment) {
  constexpr int kStart = 240;  // the object starts about frame 247 and is found nine later
  constexpr std::size_t kFound = 16, kLie = 30;
  const sim::Simulator simulator("overtake", 61);
  const SimulatedCut cut = renderCut(simulator, kStart, 40, 61);
  PipelineConfig config;
  config.segmentation.decision.lasted_frames = 8;  // as long as the cut lets it move
  PriorStage prior(config.prior);
  prior.addCameraPoses(goingWithTheBody(cut, kLie, 3));
  const SequenceRun out = runSequence(simulator.world().camera, config, prior, framesOf(cut));
  ASSERT_EQ(out.masks.size(), cut.truth.size());
  for (std::size_t k = kFound; k < out.masks.size(); ++k) {
    SCOPED_TRACE("frame " + std::to_string(k));
    EXPECT_GT(scoreSegmentation({countPixels(cut.truth[k], out.masks[k])}, 0).iou, 0.9);
  }
}

// A pause ends no reading that has lasted. At the next start both priors lie: the object's says
// that it rests on, odometry goes with it for four frames.
TEST_F(WhichWorld, IsNotTurnedByAPause) {
  constexpr int kStart = 180;  // the object rests from about frame 197 to 241
  constexpr std::size_t kRests = 20, kLie = 68, kFound = 74;
  const sim::Simulator simulator("sideway", 2);  // half of the view is the body's
  const SimulatedCut cut = renderCut(simulator, kStart, 84, 2);
  PipelineConfig config;
  config.segmentation.decision.lasted_frames = 6;  // as long as the cut lets it move
  PriorStage prior(config.prior);
  prior.addCameraPoses(goingWithTheBody(cut, kLie, 4));
  Trajectory frozen = cut.object_prior;
  for (std::size_t k = kRests; k < frozen.size(); ++k) frozen[k].pose = frozen[kRests].pose;
  prior.addObjectPoses(frozen);
  const SequenceRun out = runSequence(simulator.world().camera, config, prior, framesOf(cut));
  ASSERT_EQ(out.masks.size(), cut.truth.size());
  for (std::size_t k = kFound; k < out.masks.size(); ++k) {
    SCOPED_TRACE("frame " + std::to_string(k));
    EXPECT_GT(scoreSegmentation({countPixels(cut.truth[k], out.masks[k])}, 0).iou, 0.9);
  }
  EXPECT_LT(100 * scoreCamera(out.camera, cut.camera, out.frames).ate_first.rmse, 2.0);
}

TEST_F(WhichWorld, IsWhatATruePriorSays) { run("overtake", 1, {DriftSpec{}}); }

}  // namespace
}  // namespace rf
