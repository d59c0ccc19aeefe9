// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "capture_node.hpp"
#include "datasets/calibration.hpp"
#include "datasets/tum_source.hpp"
#include "device_node.hpp"
#include "messaging/log_source.hpp"
#include "messaging/service_config.hpp"
#include "relay_node.hpp"
#include "sensing/error.hpp"
#include "sensing/oni_source.hpp"
#include "sensing/survey.hpp"

namespace {

struct Input {
  std::string path;    ///< folder, log or .oni file
  std::string listen;  ///< or a live channel
  std::string device;  ///< or an OpenNI2 device: URI or "any"
  std::string record;  ///< then: .oni file to write
  bool wait = false;   ///< then: no device at the start is no error
  bool list = false;
  std::string calibration;

  int sources() const { return !path.empty() + !listen.empty() + !device.empty(); }
};

std::optional<rf::Calibration> readCalibration(const Input& input) {
  if (input.calibration.empty()) return std::nullopt;
  return rf::readCalibration(input.calibration);
}

std::unique_ptr<rf::FrameSource> openSource(const Input& input, const rf::DeviceConfig& device) {
  const auto calibration = readCalibration(input);
  try {
    if (std::filesystem::is_directory(input.path)) {
      return std::make_unique<rf::TumSource>(input.path, calibration);
    }
    const auto camera = calibration ? std::optional(calibration->camera) : std::nullopt;
    if (rf::isOniFile(input.path))
      return std::make_unique<rf::OniSource>(input.path, device.max_pair_gap, camera);
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
         const rf::CaptureConfig& config) {
  auto source = openSource(input, config.device);
  rf::Service service("capture", options);
  rf::CaptureNode node(service, std::move(source), config, capture, options.lockstep,
                       std::filesystem::path(input.path).filename().string());
  service.start();
  node.awaitServices();
  node.play();
  return rf::kExitStopped;
}

int grab(const rf::ServiceOptions& options, const rf::CaptureOptions& capture, const Input& input,
         const rf::CaptureConfig& config) {
  if (options.lockstep)
    throw std::invalid_argument("--lockstep: a device waits for nobody; record it, then play that");
  if (!input.record.empty() && std::filesystem::exists(input.record))
    throw std::invalid_argument("--record = '" + input.record + "': exists already");
  const auto calibration = readCalibration(input);
  rf::GrabOptions grab;
  grab.device = input.device;
  grab.config = config.device;
  if (calibration) grab.calibration = calibration->camera;
  grab.record = input.record;
  grab.wait = input.wait;
  grab.now = rf::wallUtime;
  rf::Service service("capture", options);
  rf::Grabber grabber(std::move(grab));
  rf::DeviceNode node(
      service, grabber, [&](const rf::RgbdFrame& frame) { return rf::encode(frame, config); },
      capture.channel);
  service.start();
  while (service.running()) node.step();
  return rf::kExitStopped;
}

int list() {
  const std::string text = rf::surveyDevices();
  std::cout << (text.empty() ? "no OpenNI2 device is plugged in\n" : text);
  return text.empty() ? rf::kExitNoInput : rf::kExitStopped;
}

int run(const rf::ServiceOptions& options, rf::CaptureOptions capture, Input input,
        bool await_given) {
  if (input.list) return list();
  const rf::PipelineConfig config = rf::serviceConfig(options);
  if (input.sources() != 1) throw std::invalid_argument("give one of --input, --device, --listen");
  if (rf::isOniFile(input.device)) input.path = std::exchange(input.device, {});
  if (input.device.empty() && (!input.record.empty() || input.wait))
    throw std::invalid_argument("--record and --wait belong to a --device");
  if (!input.device.empty()) return grab(options, capture, input, config.capture);
  if (!input.listen.empty()) return relay(options, capture, input);
  if (options.lockstep && !await_given) capture.lockstep.await = {"prior", "segment", "fuse"};
  return play(options, capture, input, config.capture);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-capture: publishes the frames of an OpenNI2 device, of a recording, or of a foreign LCM "
      "camera, with their calibration");
  rf::ServiceOptions options;
  rf::CaptureOptions capture;
  Input input;
  rf::addServiceOptions(app, options);
  app.add_option("--input", input.path,
                 "TUM-layout folder, LCM log with OPENNI_FRAME, or .oni file");
  app.add_option("--device", input.device,
                 "OpenNI2 device by URI, or 'any' for the first; how: --set capture.device...");
  app.add_flag("--list", input.list, "show the devices that are plugged in and their modes");
  app.add_option("--record", input.record, "with --device: write what comes to this .oni file too");
  app.add_flag("--wait", input.wait, "with --device: wait when none is plugged in yet");
  app.add_option("--listen", input.listen,
                 "live channel of bot_core.images_t on --bulk-in (openni2-camera-lcm)");
  app.add_option(
         "--calibration", input.calibration,
         "camera.yaml; default: that of the folder, RF_CAMERA of the log, or the device's own")
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
  return rf::runService("rf-capture", [&] {
    try {
      return run(options, capture, input, await->count() > 0);
    } catch (const rf::SensingError& e) {
      throw rf::InputError(e.what());
    }
  });
}
