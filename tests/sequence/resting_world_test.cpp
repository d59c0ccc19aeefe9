// SPDX-License-Identifier: BSD-3-Clause
// A world at rest, with drifting odometry: no body is made up.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include "geometry/parallel.hpp"
#include "priors/simulated_drift.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 20;
constexpr int kFrames = 40;
constexpr std::uint64_t kSeed = 1;

// The camera walks and turns.
TEST(RestingWorld, NoBodyIsBornOfMisfit) {
  const sim::Simulator simulator("loop", kSeed);
  const SimulatedCut cut = renderCut(simulator, kFirst, kFrames, kSeed);
  PipelineConfig config;
  PriorStage prior(config.prior);
  prior.addCameraPoses(cut.camera_prior);
  setThreads(2);
  const SequenceRun out = runSequence(simulator.world().camera, config, prior, framesOf(cut));
  setThreads(1);
  EXPECT_EQ(out.camera.size(), cut.frames.size());
  EXPECT_TRUE(out.object.empty());
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    EXPECT_EQ(countPixels(cut.truth[k], out.masks[k]).static_wrong, 0) << "frame " << k;
  }
}

struct OdometryOff {
  SimulatedCut cut;
  SequenceRun out;
};

// The first half second of a scene, in which nothing moves but the camera, and odometry that is off
// by a centimetre a frame.
OdometryOff runOdometryOff(const std::string& scene, std::uint64_t seed, bool object_prior) {
  constexpr int kResting = 16;
  const sim::Simulator simulator(scene, seed);
  OdometryOff run{renderCut(simulator, 0, kResting, seed), {}};
  const PipelineConfig config;
  PriorStage prior(config.prior);
  prior.addCameraPoses(withDrift(run.cut.camera, {0.34, 1.2, seed}));
  if (object_prior) prior.addObjectPoses(run.cut.object_prior);
  setThreads(2);
  run.out = runSequence(simulator.world().camera, config, prior, framesOf(run.cut));
  setThreads(1);
  return run;
}

// What a body of the whole view explains, one motion explains that the prior does not hold. A frame
// in which that motion is not found may be read so, but no model is made of it.
TEST(RestingWorld, IsNoBodyWhereOdometryIsOff) {
  const auto [cut, out] = runOdometryOff("overtake", 62, false);
  ASSERT_EQ(out.masks.size(), cut.frames.size());
  int with_body = 0;
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    const PixelCounts n = countPixels(cut.truth[k], out.masks[k]);
    with_body += n.static_wrong + n.dynamic_right > 0 ? 1 : 0;
  }
  EXPECT_LE(with_body, 1);
  EXPECT_LE(out.object.size(), 1U);
}

// Beside an object prior a body of the whole view would take the camera along with odometry.
TEST(RestingWorld, DoesNotGoToABodyFromOneFrameToTheNext) {
  const auto [cut, out] = runOdometryOff("orbit", 71, true);
  ASSERT_EQ(out.camera.size(), cut.frames.size());
  EXPECT_LT(scoreCamera(out.camera, cut.camera, out.frames).ate_first.max, 0.05);
}

}  // namespace
}  // namespace rf
