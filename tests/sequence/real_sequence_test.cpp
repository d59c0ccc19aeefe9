// SPDX-License-Identifier: BSD-3-Clause
// Cuts of two real recordings (tests/data/ATTRIBUTION.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "datasets/image_files.hpp"
#include "datasets/trajectory.hpp"
#include "datasets/tum.hpp"
#include "datasets/tum_source.hpp"
#include "evaluation/moving_pixels.hpp"
#include "geometry/parallel.hpp"
#include "priors/simulated_drift.hpp"
#include "sequence_run.hpp"

namespace rf {
namespace {

SequenceRun run(const std::string& folder, const Trajectory& camera_prior) {
  setThreads(2);
  TumSource source(folder);
  PipelineConfig config;
  PriorStage prior(config.prior);
  if (!camera_prior.empty()) prior.addCameraPoses(camera_prior);
  const SequenceRun out =
      runSequence(source.camera(), config, prior, [&]() -> std::optional<RgbdFrame> {
        std::optional<SourcedFrame> f = source.next();
        return f ? std::move(f->frame) : std::nullopt;
      });
  setThreads(1);
  return out;
}

// In 1.5 s a drifting prior may by chance be as good as the truth: the mean over some drifts
// counts.
TEST(RealSequence, RotatingCameraBeatsItsDriftingPriors) {
  const std::string folder = std::string(RF_TEST_DATA) + "/tum_fr1_rpy";
  const Trajectory truth = readTrajectory(folder + "/groundtruth.txt");
  double camera_aligned = 0, prior_aligned = 0, camera_first = 0, prior_first = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Trajectory prior = withDrift(truth, {0.06, 0.4, seed, DriftStream::kCamera});
    const SequenceRun out = run(folder, prior);
    const TrajectoryScore camera = scoreCamera(out.camera, truth, out.frames);
    const TrajectoryScore drift = scoreCamera(prior, truth, out.frames);
    EXPECT_LT(camera.ate_aligned.rmse, 0.04) << "drift seed " << seed;
    EXPECT_EQ(camera.coverage, 1.0) << "drift seed " << seed;
    camera_aligned += camera.ate_aligned.rmse;
    prior_aligned += drift.ate_aligned.rmse;
    camera_first += camera.ate_first.rmse;
    prior_first += drift.ate_first.rmse;
  }
  EXPECT_LT(camera_aligned, prior_aligned);
  EXPECT_LT(camera_first, prior_first);
}

std::string handMask(const std::string& folder, std::int64_t utime) {
  const std::string time = formatTumPose(utime, SE3());
  return folder + "/masks_hand/" + time.substr(0, time.find(' ')) + ".png";
}

// What the masks that were drawn by hand say of the map.
MapOnMoving mapOnPeople(const std::string& folder, const SequenceRun& run) {
  const TumDataset dataset(folder);
  MovingPixels people(run.world, dataset.calibration().camera);
  for (std::size_t k = 0; k < dataset.size(); ++k) {
    const auto loaded = dataset.load(k).frame;
    const auto pose = std::find_if(run.camera.begin(), run.camera.end(), [&](const StampedPose& p) {
      return loaded && p.utime == loaded->utime;
    });
    if (pose == run.camera.end()) continue;
    const std::string path = handMask(folder, pose->utime);
    if (!std::filesystem::exists(path)) continue;
    const Image<std::uint16_t>& depth = loaded->depth_mm;
    people.add({readGreyImage(path, depth.width(), depth.height()), depth, pose->pose});
  }
  return people.result();
}

TEST(RealSequence, PeopleAreFoundWithoutAnyPriorAndTheMapIsFreeOfThem) {
  const std::string folder = std::string(RF_TEST_DATA) + "/tum_fr3_walking_halfsphere";
  const SequenceRun out = run(folder, {});
  int compared = 0;
  int found = 0;
  double iou = 0;
  for (std::size_t k = 0; k < out.frames.size(); ++k) {
    const std::string path = handMask(folder, out.frames[k]);
    if (!std::filesystem::exists(path)) continue;
    const Image<std::uint8_t> hand =
        readGreyImage(path, out.masks[k].width(), out.masks[k].height());
    const PixelCounts counts = countPixels(hand, out.masks[k]);
    ++compared;
    iou += counts.iou();
    if (counts.dynamicAccuracy() > 0.5 && counts.staticAccuracy() > 0.7) ++found;
  }
  ASSERT_GE(compared, 5);
  EXPECT_GE(found, compared - 1) << "most of both people's pixels in most frames";
  EXPECT_GT(iou / compared, 0.6);
  const MapOnMoving map = mapOnPeople(folder, out);
  EXPECT_EQ(map.frames, static_cast<std::size_t>(compared));
  EXPECT_GT(map.surfels, 10000U);
  EXPECT_LT(map.share(), 0.02) << "what a man who sat left of himself when he got up counts 0.036";
}

}  // namespace
}  // namespace rf
