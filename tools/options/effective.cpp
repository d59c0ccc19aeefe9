// SPDX-License-Identifier: BSD-3-Clause
#include "options/effective.hpp"

#include <filesystem>
#include <vector>

#include "config/yaml.hpp"
#include "datasets/error.hpp"
#include "datasets/robot_folder.hpp"
#include "datasets/trajectory.hpp"
#include "datasets/tum_source.hpp"
#include "messaging/log_source.hpp"
#include "priors/simulated_drift.hpp"
#include "sensing/error.hpp"
#include "sensing/oni_source.hpp"

namespace rf {
namespace {

Trajectory drifted(const Trajectory& truth, const RunOptions& options, DriftStream stream) {
  const std::size_t at = stream == DriftStream::kCamera ? 0 : 2;
  if (options.simulate_drift.size() < at + 2) return truth;
  return withDrift(truth, {options.simulate_drift[at], options.simulate_drift[at + 1],
                           options.drift_seed, stream});
}

/// The camera's pose by the robot at each sample of its odometry.
void saveRobotPrior(const RunOptions& options) {
  const RobotPrior robot = readRobot(options.robotFolder(), effectiveConfig(options).prior).robot;
  TrajectoryWriter writer(options.output + "/camera_prior.txt", "timestamp tx ty tz qx qy qz qw");
  for (const std::int64_t utime : robot.odometry().times()) {
    if (const auto T_WC = robot.cameraPose(utime)) writer.add(utime, *T_WC);
  }
}

std::unique_ptr<FrameSource> openOni(const RunOptions& options,
                                     const std::optional<Camera>& camera) {
  const double max_gap = effectiveConfig(options).capture.device.max_pair_gap;
  try {
    return std::make_unique<OniSource>(options.input, max_gap, camera);
  } catch (const SensingError& e) {
    throw DatasetError(e.what());
  }
}

}  // namespace

PipelineConfig effectiveConfig(const RunOptions& options) {
  PipelineConfig config;
  if (const std::string folder = options.robotFolder(); !folder.empty())
    loadRobotConfig(folder, config.prior);
  if (!options.config.empty()) loadConfigFile(options.config, config);
  if (!options.mode.empty()) overrideConfig("segmentation.mode=" + options.mode, config);
  for (const std::string& assignment : options.set) overrideConfig(assignment, config);
  checkConfig(config, "configuration");
  return config;
}

PriorStage makePriorStage(const PriorConfig& config, const RunOptions& options,
                          std::vector<std::string>& remarks) {
  PriorStage stage(config);
  if (const std::string file = options.cameraPriorFile(); !file.empty()) {
    stage.addCameraPoses(drifted(readTrajectory(file), options, DriftStream::kCamera));
  }
  if (const std::string file = options.objectPriorFile(); !file.empty()) {
    stage.addObjectPoses(drifted(readTrajectory(file), options, DriftStream::kObject));
  }
  if (const std::string folder = options.robotFolder(); !folder.empty()) {
    RobotRecording recording = readRobot(folder, config);
    stage.useRobot(std::move(recording.robot), options.robotGivesCamera(),
                   options.robotGivesObject());
    remarks = std::move(recording.remarks);
  }
  return stage;
}

void savePriors(const RunOptions& options) {
  const auto save = [&](const std::string& file, DriftStream stream, const char* name) {
    if (file.empty()) return;
    TrajectoryWriter writer(options.output + "/" + name, "timestamp tx ty tz qx qy qz qw");
    for (const StampedPose& p : drifted(readTrajectory(file), options, stream)) {
      writer.add(p.utime, p.pose);
    }
  };
  save(options.cameraPriorFile(), DriftStream::kCamera, "camera_prior.txt");
  if (options.robotGivesCamera()) saveRobotPrior(options);
  save(options.objectPriorFile(), DriftStream::kObject, "object_prior.txt");
}

std::unique_ptr<FrameSource> openSource(const RunOptions& options) {
  std::optional<Calibration> calibration;
  if (!options.calibration.empty()) calibration = readCalibration(options.calibration);
  if (std::filesystem::is_directory(options.input)) {
    return std::make_unique<TumSource>(options.input, calibration);
  }
  const auto camera = calibration ? std::optional(calibration->camera) : std::nullopt;
  if (isOniFile(options.input)) return openOni(options, camera);
  return std::make_unique<LcmLogSource>(options.input, camera);
}

}  // namespace rf
