// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <filesystem>

#include "capture_node.hpp"
#include "datasets/calibration.hpp"
#include "datasets/tum_source.hpp"
#include "messaging/log_source.hpp"
#include "messaging/service_config.hpp"
#include "relay_node.hpp"

namespace {

struct Input {
  std::string path;    ///< folder or log
  std::string listen;  ///< or a live channel
  std::string calibration;
};

std::optional<rf::Calibration> readCalibration(const Input& input) {
  if (input.calibration.empty()) return std::nullopt;
  return rf::readCalibration(input.calibration);
}

std::unique_ptr<rf::FrameSource> openSource(const Input& input) {
  const auto calibration = readCalibration(input);
  try {
    if (std::filesystem::is_directory(input.path)) {
      return std::make_unique<rf::TumSource>(input.path, calibration);
    }
    const auto camera = calibration ? std::optional(calibration->camera) : std::nullopt;
    return std::make_unique<rf::LcmLogSource>(input.path, camera);
  } catch (const rf::ConfigError&) {
    throw;
  } catch (const std::exception& e) {
    throw rf::InputError(e.what());
  }
}

int relay(const rf::ServiceOptions& options, const rf::CaptureOptions& capture,
          const Input& input) {
  const auto calibration = readCalibration(input);
  if (!calibration)
    throw std::invalid_argument("--listen needs --calibration: foreign images carry none");
  if (input.listen == capture.channel && options.bulk_out.empty()) {
    throw std::invalid_argument(
        "--listen and --channel are the same channel of one bus: it would hear itself");
  }
  rf::Service service("capture", options);
  rf::RelayNode node(service, input.listen, capture.channel, calibration->camera);
  service.start();
  while (service.running()) {
    if (!node.step()) service.wait(std::chrono::milliseconds(20));
  }
  return rf::kExitStopped;
}

int play(const rf::ServiceOptions& options, const rf::CaptureOptions& capture, const Input& input,
         const rf::CodecOptions& codec) {
  auto source = openSource(input);
  rf::Service service("capture", options);
  rf::CaptureNode node(service, std::move(source), codec, capture, options.lockstep,
                       std::filesystem::path(input.path).filename().string());
  service.start();
  node.awaitServices();
  node.play();
  return rf::kExitStopped;
}

int run(const rf::ServiceOptions& options, rf::CaptureOptions capture, const Input& input,
        bool await_given) {
  const rf::PipelineConfig config = rf::serviceConfig(options);
  if (input.path.empty() == input.listen.empty())
    throw std::invalid_argument("give either --input or --listen");
  if (!input.listen.empty()) return relay(options, capture, input);
  if (options.lockstep && !await_given) capture.lockstep.await = {"prior", "segment", "fuse"};
  return play(options, capture, input, config.capture);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-capture: publishes the frames of a recording, or of a foreign LCM camera, with their "
      "calibration");
  rf::ServiceOptions options;
  rf::CaptureOptions capture;
  Input input;
  rf::addServiceOptions(app, options);
  app.add_option("--input", input.path, "TUM-layout folder, or LCM log with OPENNI_FRAME");
  app.add_option("--listen", input.listen,
                 "live channel of bot_core.images_t on --bulk-in (openni2-camera-lcm)");
  app.add_option("--calibration", input.calibration,
                 "camera.yaml; default: that of the folder, or RF_CAMERA of the log")
      ->check(CLI::ExistingFile);
  app.add_option("--channel", capture.channel, "channel to publish frames on")
      ->capture_default_str();
  app.add_option("--speed", capture.speed, "live: times the recorded rate; 0: as fast as possible")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  auto* await =
      app.add_option("--await", capture.lockstep.await,
                     "services that must be ready first (default: prior,segment,fuse in lockstep)")
          ->delimiter(',');
  rf::addLockstepOptions(app, capture.lockstep);
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-capture",
                        [&] { return run(options, capture, input, await->count() > 0); });
}
