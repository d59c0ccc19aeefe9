// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "datasets/robot_folder.hpp"
#include "datasets/trajectory.hpp"
#include "messaging/service_config.hpp"
#include "prior_node.hpp"
#include "priors/simulated_drift.hpp"

namespace {

struct Files {
  std::string camera;
  std::string object;
  std::vector<double> drift;
  std::uint64_t drift_seed = 1;
  std::string robot;
  bool robot_no_camera = false;
  bool robot_no_object = false;
};

rf::Trajectory readDrifted(const std::string& path, const Files& files, rf::DriftStream stream) {
  rf::Trajectory trajectory = rf::readTrajectory(path);
  const std::size_t at = stream == rf::DriftStream::kCamera ? 0 : 2;
  if (files.drift.size() < at + 2) return trajectory;
  return rf::withDrift(trajectory,
                       {files.drift[at], files.drift[at + 1], files.drift_seed, stream});
}

rf::PipelineConfig effectiveConfig(const rf::ServiceOptions& options, const Files& files) {
  rf::PipelineConfig config;
  if (!files.robot.empty()) rf::loadRobotConfig(files.robot, config.prior);
  return rf::serviceConfig(options, config);
}

/// The robot with its recorded samples, or without where it speaks live.
std::vector<std::string> addRobot(rf::PriorStage& stage, const rf::PriorConfig& config,
                                  const Files& files, bool live) {
  rf::RobotRecording recording = live ? rf::RobotRecording{rf::openRobot(files.robot, config), {}}
                                      : rf::readRobot(files.robot, config);
  stage.useRobot(std::move(recording.robot), !files.robot_no_camera, !files.robot_no_object);
  return recording.remarks;
}

int run(const rf::ServiceOptions& options, rf::PriorOptions prior, const Files& files) {
  const rf::PipelineConfig config = effectiveConfig(options, files);
  rf::PriorStage stage(config.prior);
  std::vector<std::string> remarks;
  if (!files.robot.empty()) remarks = addRobot(stage, config.prior, files, prior.robot_live);
  prior.robot = config.prior.robot.channels;
  if (!files.camera.empty())
    stage.addCameraPoses(readDrifted(files.camera, files, rf::DriftStream::kCamera));
  if (!files.object.empty())
    stage.addObjectPoses(readDrifted(files.object, files, rf::DriftStream::kObject));
  rf::Service service("prior", options);
  rf::PriorNode node(service, std::move(stage), prior);
  service.start();
  for (const std::string& remark : remarks) service.info("robot: " + remark);
  while (service.running()) {
    if (!node.step()) service.wait(std::chrono::milliseconds(5));
  }
  return rf::kExitStopped;
}

std::string problem(const Files& files, const rf::PriorOptions& prior) {
  if (!files.camera.empty() && !prior.camera_channel.empty())
    return "--camera and --camera-channel exclude each other";
  if (!files.object.empty() && !prior.object_channel.empty())
    return "--object and --object-channel exclude each other";
  if (prior.robot_live && files.robot.empty())
    return "--robot-live needs --robot: the folder with the URDF";
  if (!files.drift.empty() && files.drift.size() != 2 && files.drift.size() != 4) {
    return "--simulate-drift: give V,W (camera) or V,W,V,W (camera, object)";
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-prior: motion priors of camera and object from trajectory files, bot_core.pose_t, or a "
      "robot");
  rf::ServiceOptions options;
  rf::PriorOptions prior;
  Files files;
  rf::addServiceOptions(app, options);
  app.add_option("--camera", files.camera, "camera poses T_WC, TUM trajectory file")
      ->check(CLI::ExistingFile);
  app.add_option("--object", files.object, "object poses T_WO, TUM trajectory file")
      ->check(CLI::ExistingFile);
  app.add_option("--camera-channel", prior.camera_channel,
                 "live camera (body) poses, for example POSE_BODY");
  app.add_option("--object-channel", prior.object_channel, "live object poses");
  app.add_option("--robot", files.robot,
                 "robot folder: robot.yaml, URDF and recorded odometry, joints and grasps; gives "
                 "the priors that nothing else gives")
      ->check(CLI::ExistingDirectory);
  app.add_flag("--robot-live", prior.robot_live,
               "take the robot's samples from the channels of prior.robot.channels instead");
  app.add_flag("--robot-no-camera", files.robot_no_camera, "the robot gives no camera prior");
  app.add_flag("--robot-no-object", files.robot_no_object, "the robot gives no object prior");
  app.add_option("--wait-ms", prior.wait_ms,
                 "how long a frame waits for live poses beyond its time")
      ->capture_default_str()
      ->check(CLI::Range(0, 60000));
  app.add_option("--simulate-drift", files.drift,
                 "V,W[,V,W]: mean drift of camera (and object) added to the files, m/s and rad/s")
      ->delimiter(',');
  app.add_option("--drift-seed", files.drift_seed, "seed of the simulated drift")
      ->capture_default_str();
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-prior", [&] {
    if (const auto why = problem(files, prior); !why.empty()) throw std::invalid_argument(why);
    return run(options, prior, files);
  });
}
