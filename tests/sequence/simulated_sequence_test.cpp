// SPDX-License-Identifier: BSD-3-Clause
// The default mode on a cut of a simulated sequence that holds the onset, under the paper's drift.
#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 24;  // the object starts about frame 36
constexpr int kFrames = 60;
constexpr std::uint64_t kSeed = 41;

const sim::Simulator& simulator() {
  static const sim::Simulator instance("overtake", kSeed);
  return instance;
}

const SimulatedCut& scene() {
  static const SimulatedCut instance = renderCut(simulator(), kFirst, kFrames, kSeed);
  return instance;
}

enum class Priors { kBoth, kCameraOnly };

SequenceRun run(int threads, Priors priors, const std::string& mode = "rigidfusion") {
  setThreads(threads);
  PipelineConfig config;
  config.segmentation.mode = mode;
  PriorStage prior(config.prior);
  prior.addCameraPoses(scene().camera_prior);
  if (priors == Priors::kBoth) prior.addObjectPoses(scene().object_prior);
  const SequenceRun out = runSequence(simulator().world().camera, config, prior, framesOf(scene()));
  setThreads(1);
  return out;
}

double cm(const ErrorStatistics& e) { return 100 * e.rmse; }

TEST(SimulatedSequence, DefaultModeBeatsItsPriorAndFindsTheObject) {
  const SequenceRun out = run(2, Priors::kBoth);
  const TrajectoryScore camera = scoreCamera(out.camera, scene().camera, out.frames);
  const TrajectoryScore prior = scoreCamera(scene().camera_prior, scene().camera, out.frames);
  EXPECT_LT(cm(camera.ate_first), cm(prior.ate_first));
  EXPECT_LT(cm(camera.ate_first), 3.0);
  EXPECT_EQ(camera.coverage, 1.0);
  std::vector<PixelCounts> counts;
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    if (scene().speed[k] > 0.03) counts.push_back(countPixels(scene().truth[k], out.masks[k]));
  }
  ASSERT_GT(counts.size(), 20U);
  const SegmentationScore score = scoreSegmentation(counts, 0);
  EXPECT_GT(score.iou, 0.8);
  EXPECT_GT(score.static_accuracy, 0.9);
  const SE3 world = alignFirstPose(matchPoses(out.camera, scene().camera));
  const TrajectoryScore object = scoreObject(out.object, scene().object, out.frames, world);
  EXPECT_LT(cm(object.ate_first), 3.0);
}

TEST(SimulatedSequence, OneAndTwoThreadsGiveTheSameBits) {
  const SequenceRun one = run(1, Priors::kBoth);
  const SequenceRun two = run(2, Priors::kBoth);
  EXPECT_EQ(one.camera, two.camera);
  EXPECT_EQ(one.object, two.object);
  EXPECT_EQ(one.masks, two.masks);
}

TEST(SimulatedSequence, EveryModeRunsAndCoversEveryFrame) {
  for (const char* mode : {"rigidfusion-paper", "static", "static-prior", "vo"}) {
    const SequenceRun out = run(2, Priors::kBoth, mode);
    EXPECT_EQ(out.camera.size(), scene().frames.size()) << mode;
  }
}

TEST(SimulatedSequence, WithoutAnObjectPriorTheOutlierRuleFindsTheObject) {
  const SequenceRun out = run(2, Priors::kCameraOnly);
  std::vector<PixelCounts> counts;
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    if (scene().speed[k] > 0.1) counts.push_back(countPixels(scene().truth[k], out.masks[k]));
  }
  EXPECT_GT(scoreSegmentation(counts, 0).iou, 0.5);
}

}  // namespace
}  // namespace rf
