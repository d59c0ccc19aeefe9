// SPDX-License-Identifier: BSD-3-Clause
// A slow start: until the labels are right the dominant motion lies between the world's and the
// body's, and must not take the camera along.
#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 20;  // the object starts at frame 30 and has moved 1 cm at frame 43
constexpr int kFrames = 40;
constexpr std::uint64_t kSeed = 2;

/// With both priors, and two threads.
SequenceRun run(const sim::Simulator& simulator, const SimulatedCut& cut,
                const PipelineConfig& config) {
  PriorStage prior(config.prior);
  prior.addCameraPoses(cut.camera_prior);
  prior.addObjectPoses(cut.object_prior);
  setThreads(2);
  SequenceRun out = runSequence(simulator.world().camera, config, prior, framesOf(cut));
  setThreads(1);
  return out;
}

TEST(Onset, TheCameraStaysWithTheWorld) {
  const sim::Simulator simulator("orbit", kSeed);
  const SimulatedCut cut = renderCut(simulator, kFirst, kFrames, kSeed);
  const SequenceRun out = run(simulator, cut, {});
  ASSERT_EQ(out.camera.size(), cut.frames.size());
  const TrajectoryScore camera = scoreCamera(out.camera, cut.camera, out.frames);
  EXPECT_LT(camera.ate_first.max, 0.015) << "dragged: 0.03 and more";

  std::vector<PixelCounts> counts;
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    const double moved = (cut.object[k].pose.t - cut.object.front().pose.t).norm();
    if (moved > 0.02) counts.push_back(countPixels(cut.truth[k], out.masks[k]));
  }
  ASSERT_GT(counts.size(), 10U);
  EXPECT_GT(scoreSegmentation(counts, 0).iou, 0.9);
}

// After a rest, a body that has lasted takes less to be found than one that was never seen (eleven
// frames here).
TEST(Onset, ABodyThatIsKnownIsFoundSooner) {
  constexpr int kMoving = 165;  // it rests from frame 194 to 242
  constexpr std::size_t kRestarts = 242 - kMoving;
  constexpr std::uint64_t kRested = 62;
  const sim::Simulator simulator("orbit", kRested);
  const SimulatedCut cut = renderCut(simulator, kMoving, 90, kRested);
  PipelineConfig config;
  config.segmentation.decision.lasted_frames = 15;  // as long as the cut lets it move
  const SequenceRun out = run(simulator, cut, config);
  ASSERT_EQ(out.masks.size(), cut.frames.size());
  std::size_t found = kRestarts;
  while (found < out.masks.size() &&
         scoreSegmentation({countPixels(cut.truth[found], out.masks[found])}, 0).iou < 0.8) {
    ++found;
  }
  EXPECT_LE(found - kRestarts, 5U);
}

}  // namespace
}  // namespace rf
