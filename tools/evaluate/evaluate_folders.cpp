// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_folders.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "datasets/covariance_table.hpp"
#include "datasets/error.hpp"
#include "datasets/ply.hpp"
#include "datasets/trajectory.hpp"
#include "datasets/tum.hpp"
#include "map_on_moving.hpp"
#include "mask_folder.hpp"
#include "priors/pose_buffer.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

constexpr double kAnyMotion = 1e-3;  // m/s
constexpr std::int64_t kSameMomentUs = 20000;
constexpr double kPriorMaxGap = 0.2;

std::string in(const std::string& folder, const char* name) {
  return (fs::path(folder) / name).string();
}

struct Inputs {
  std::vector<std::int64_t> frames;
  Trajectory camera_truth;
  Trajectory object_truth;
  Trajectory camera;
  Trajectory object;
  SE3 world;  ///< result's world -> truth's world, from the camera's first pose
};

Trajectory readIfThere(const std::string& path) {
  return fs::exists(path) ? readTrajectory(path) : Trajectory();
}

Inputs readInputs(const EvaluationRequest& request) {
  Inputs inputs;
  for (const TumEntry& entry : indexTumFolder(request.sequence).frames) {
    inputs.frames.push_back(entry.utime);
  }
  inputs.camera_truth = readIfThere(in(request.sequence, "groundtruth.txt"));
  inputs.object_truth = readIfThere(in(request.sequence, "object_groundtruth.txt"));
  inputs.camera = readTrajectory(in(request.result, "camera.txt"));
  inputs.object = readIfThere(in(request.result, "object.txt"));
  inputs.world = alignFirstPose(matchPoses(inputs.camera, inputs.camera_truth));
  return inputs;
}

/// The prior sampled at the frames, so that it is judged on the same moments as the estimate.
Trajectory sampleAt(const Trajectory& prior, const std::vector<std::int64_t>& frames) {
  PoseBuffer buffer(std::max<std::size_t>(2, prior.size()));
  for (const StampedPose& p : prior) buffer.add(p.utime, p.pose);
  Trajectory sampled;
  for (const std::int64_t utime : frames) {
    const PoseAt at = buffer.at(utime, kPriorMaxGap, 0.0);
    if (at.state == PriorState::kValid) sampled.push_back({utime, at.pose});
  }
  return sampled;
}

/// The prior that was used: the option's, else the one saved with the result, else the sequence's.
Trajectory readPrior(const std::string& option, const EvaluationRequest& request,
                     const char* in_result, const char* in_sequence) {
  if (option == "none") return {};
  if (!option.empty()) return readTrajectory(option);
  const std::string saved = in(request.result, in_result);
  return readIfThere(fs::exists(saved) ? saved : in(request.sequence, in_sequence));
}

void scoreTrajectories(const EvaluationRequest& request, const Inputs& inputs,
                       EvaluationReport& report) {
  const Trajectory camera_prior = sampleAt(
      readPrior(request.camera_prior, request, "camera_prior.txt", "odometry.txt"), inputs.frames);
  const Trajectory object_prior =
      sampleAt(readPrior(request.object_prior, request, "object_prior.txt", "object_odometry.txt"),
               inputs.frames);
  if (inputs.camera_truth.empty()) {
    report.notes.emplace_back("no groundtruth.txt: camera not compared");
  } else {
    report.camera = scoreCamera(inputs.camera, inputs.camera_truth, inputs.frames);
    if (report.camera->matched == 0) {
      report.notes.emplace_back("no pose of camera.txt is within 20 ms of a true one");
    }
    if (!camera_prior.empty()) {
      report.camera_prior = scoreCamera(camera_prior, inputs.camera_truth, inputs.frames);
    }
  }
  if (inputs.object_truth.empty()) {
    report.notes.emplace_back("no object_groundtruth.txt: object not compared");
    return;
  }
  report.object = scoreObject(inputs.object, inputs.object_truth, inputs.frames, inputs.world);
  if (inputs.object.empty()) report.notes.emplace_back("no pose of the object in the result");
  if (!object_prior.empty()) {
    const SE3 prior_world = alignFirstPose(matchPoses(camera_prior, inputs.camera_truth));
    report.object_prior =
        scoreObject(object_prior, inputs.object_truth, inputs.frames, prior_world);
  }
}

void scoreCovariances(const EvaluationRequest& request, const Inputs& inputs,
                      EvaluationReport& report) {
  const std::string path = in(request.result, "covariance.csv");
  if (!fs::exists(path) || inputs.camera_truth.empty()) return;
  const CovarianceFile file = readCovariances(path);
  report.camera_consistency = scoreConsistency(errorSamples(
      matchPoses(inputs.camera, inputs.camera_truth), file.camera, inputs.world, SE3()));
  const auto offset = objectOffset(inputs.object, inputs.object_truth, inputs.world);
  if (!offset) return;
  report.object_consistency = scoreConsistency(errorSamples(
      matchPoses(inputs.object, inputs.object_truth), file.object, inputs.world, *offset));
}

/// True speed of the object at a time; nothing where there is no truth within 20 ms.
class SpeedTable {
 public:
  explicit SpeedTable(const Trajectory& truth) : truth_(truth), speeds_(speeds(truth)) {}
  std::optional<double> at(std::int64_t utime) const {
    const auto after =
        std::lower_bound(truth_.begin(), truth_.end(), utime - kSameMomentUs,
                         [](const StampedPose& p, std::int64_t t) { return p.utime < t; });
    std::optional<double> speed;
    std::int64_t nearest = kSameMomentUs + 1;
    for (auto p = after; p != truth_.end() && p->utime <= utime + kSameMomentUs; ++p) {
      if (std::abs(p->utime - utime) >= nearest) continue;
      nearest = std::abs(p->utime - utime);
      speed = speeds_[static_cast<std::size_t>(p - truth_.begin())];
    }
    return speed;
  }

 private:
  const Trajectory& truth_;
  std::vector<double> speeds_;
};

struct FrameSet {
  std::vector<PixelCounts> counts;
  std::size_t missing = 0;
  void add(const PixelCounts& c, bool is_missing) {
    counts.push_back(c);
    missing += is_missing ? 1 : 0;
  }
};

std::string truthMaskFolder(const EvaluationRequest& request) {
  if (!request.truth_masks.empty()) return request.truth_masks;
  const std::string exact = in(request.sequence, "mask");
  return fs::is_directory(exact) ? exact : in(request.sequence, "masks_hand");
}

void scoreMasks(const EvaluationRequest& request, const Inputs& inputs, EvaluationReport& report) {
  const auto truth = listMasks(truthMaskFolder(request));
  const auto found = listMasks(in(request.result, "masks"));
  if (truth.empty() || found.empty()) {
    report.notes.emplace_back(truth.empty() ? "no true masks: segmentation not compared"
                                            : "no masks in the result: segmentation not compared");
    return;
  }
  const bool judge_speed = !inputs.object_truth.empty();
  if (!judge_speed) report.notes.emplace_back("no true object motion: all true masks are used");
  const SpeedTable speed_at(inputs.object_truth);
  FrameSet fast;
  FrameSet moving;
  PixelCounts all;
  for (const std::int64_t utime : inputs.frames) {
    const auto mask = truth.find(utime);
    if (mask == truth.end()) continue;
    const double speed = judge_speed ? speed_at.at(utime).value_or(0.0) : 1e9;
    const auto result = found.find(utime);
    const bool missing = result == found.end();
    const Image<std::uint8_t> true_mask = readMask(mask->second);
    const PixelCounts counts =
        missing ? countMissing(true_mask) : countPixels(true_mask, readMask(result->second));
    all += counts;
    if (speed > kAnyMotion) moving.add(counts, missing);
    if (speed > request.speed_threshold) fast.add(counts, missing);
  }
  if (all.self_right + all.self_missed > 0) report.self = all;
  report.fast = scoreSegmentation(fast.counts, fast.missing);
  report.moving = scoreSegmentation(moving.counts, moving.missing);
}

std::optional<ModelScore> scoreFile(const std::string& model, const std::string& truth,
                                    const SE3& T_truth_model, EvaluationReport& report) {
  if (!fs::exists(truth)) return std::nullopt;
  if (!fs::exists(model)) {
    report.notes.push_back(model + ": is not there, model not compared");
    return std::nullopt;
  }
  return scoreModel(readPly(model), readPly(truth), T_truth_model);
}

void scoreModels(const EvaluationRequest& request, const Inputs& inputs, EvaluationReport& report) {
  report.static_model = scoreFile(in(request.result, "static.ply"),
                                  in(request.sequence, "surface.ply"), inputs.world, report);
  if (!report.static_model) {
    report.static_on_moving =
        scoreMapOnMoving(request.sequence, request.result, truthMaskFolder(request), inputs.camera);
  }
  const auto offset = objectOffset(inputs.object, inputs.object_truth, inputs.world);
  if (!offset) return;
  report.object_model =
      scoreFile(in(request.result, "object.ply"), in(request.sequence, "object_surface.ply"),
                offset->inverse(), report);
}

/// Counts of one frame; a frame without a result is counted as one that found nothing.
void addPixels(const std::string& truth_file, const std::optional<std::string>& found_file,
               FrameScore& frame) {
  const Image<std::uint8_t> truth = readMask(truth_file);
  frame.dynamic_share = dynamicShare(truth);
  frame.pixels = found_file ? countPixels(truth, readMask(*found_file)) : countMissing(truth);
}

std::vector<FrameScore> scoreEachFrame(const EvaluationRequest& request, const Inputs& inputs) {
  const SE3 X = objectOffset(inputs.object, inputs.object_truth, inputs.world).value_or(SE3());
  std::vector<FrameScore> frames =
      scoreFrames(inputs.frames, {inputs.camera, inputs.camera_truth, inputs.world, SE3()},
                  {inputs.object, inputs.object_truth, inputs.world, X}, kAnyMotion);
  const auto truth = listMasks(truthMaskFolder(request));
  const auto found = listMasks(in(request.result, "masks"));
  if (found.empty()) return frames;
  for (FrameScore& frame : frames) {
    const auto mask = truth.find(frame.utime);
    if (mask == truth.end()) continue;
    const auto result = found.find(frame.utime);
    addPixels(mask->second, result == found.end() ? std::nullopt : std::optional(result->second),
              frame);
  }
  return frames;
}

}  // namespace

EvaluationReport evaluateFolders(const EvaluationRequest& request) {
  const Inputs inputs = readInputs(request);
  EvaluationReport report;
  report.speed_threshold = request.speed_threshold;
  scoreTrajectories(request, inputs, report);
  scoreCovariances(request, inputs, report);
  scoreMasks(request, inputs, report);
  scoreModels(request, inputs, report);
  if (request.each_frame) report.each_frame = scoreEachFrame(request, inputs);
  return report;
}

}  // namespace rf
