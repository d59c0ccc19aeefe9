// SPDX-License-Identifier: BSD-3-Clause
// A camera that walks and turns through a world at rest, with drifting odometry and no object
// prior: no body is made up.
#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 20;
constexpr int kFrames = 40;
constexpr std::uint64_t kSeed = 1;

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

}  // namespace
}  // namespace rf
