// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

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
};

rf::Trajectory readDrifted(const std::string& path, const Files& files, rf::DriftStream stream) {
  rf::Trajectory trajectory = rf::readTrajectory(path);
  const std::size_t at = stream == rf::DriftStream::kCamera ? 0 : 2;
  if (files.drift.size() < at + 2) return trajectory;
  return rf::withDrift(trajectory,
                       {files.drift[at], files.drift[at + 1], files.drift_seed, stream});
}

int run(const rf::ServiceOptions& options, const rf::PriorOptions& prior, const Files& files) {
  const rf::PipelineConfig config = rf::serviceConfig(options);
  rf::PriorStage stage(config.prior);
  if (!files.camera.empty())
    stage.addCameraPoses(readDrifted(files.camera, files, rf::DriftStream::kCamera));
  if (!files.object.empty())
    stage.addObjectPoses(readDrifted(files.object, files, rf::DriftStream::kObject));
  rf::Service service("prior", options);
  rf::PriorNode node(service, std::move(stage), prior);
  service.start();
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
  if (!files.drift.empty() && files.drift.size() != 2 && files.drift.size() != 4) {
    return "--simulate-drift: give V,W (camera) or V,W,V,W (camera, object)";
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-prior: motion priors of camera and object from trajectory files or bot_core.pose_t");
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
