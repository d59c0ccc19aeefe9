// SPDX-License-Identifier: BSD-3-Clause
// A body that nothing announced, and no camera prior that could tell which of two motions is the
// world's: mask and world are not swapped.
#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "priors/simulated_drift.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 20;  // the object starts about frame 33, with a third of the view
constexpr int kFrames = 60;
constexpr std::uint64_t kSeed = 41;

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

TEST(WorthlessPrior, TheLargerPartOfTheViewIsTheWorld) {
  const sim::Simulator simulator("sideway", kSeed);
  const SimulatedCut cut = renderCut(simulator, kFirst, kFrames, kSeed);
  const PipelineConfig config;
  setThreads(2);
  {
    SCOPED_TRACE("no camera prior");
    expectRight(cut, runSequence(simulator.world().camera, config, PriorStage(config.prior),
                                 framesOf(cut)));
  }
  {
    SCOPED_TRACE("a camera prior that drifts by 34 cm/s");
    PriorStage prior(config.prior);
    prior.addCameraPoses(withDrift(cut.camera, {0.34, 1.2, kSeed, DriftStream::kCamera}));
    expectRight(cut, runSequence(simulator.world().camera, config, prior, framesOf(cut)));
  }
  setThreads(1);
}

}  // namespace
}  // namespace rf
