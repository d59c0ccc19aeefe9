// SPDX-License-Identifier: BSD-3-Clause
// rf-replay: feeds running services from a recorded log, losslessly.
#include <CLI/CLI.hpp>

#include "messaging/service_config.hpp"
#include "replay_node.hpp"

int main(int argc, char** argv) {
  CLI::App app(
      "rf-replay: publishes the inputs in an LCM log again, for services that are running "
      "(--lockstep ones, unless\n"
      "--speed is given). By default these are the frames, their ticks and the recorded priors; to "
      "have rf-prior\n"
      "answer instead, leave RF_MOTION_PRIOR out of --channels.");
  rf::ServiceOptions options;
  rf::ReplayOptions replay;
  replay.lockstep.await = {"segment", "fuse"};
  rf::addServiceOptions(app, options);
  app.add_option("log", replay.log, "LCM log")->required();
  app.add_option("--channels", replay.channels, "what to publish, regular expression, whole name")
      ->capture_default_str();
  app.add_option("--frame-channel", replay.frame_channel, "frames in the log")
      ->capture_default_str();
  app.add_option("--speed", replay.speed,
                 "times the recorded rate, without waiting for results; 0: lockstep")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1000.0));
  app.add_option("--await", replay.lockstep.await, "services that must be ready first")
      ->delimiter(',')
      ->capture_default_str();
  rf::addLockstepOptions(app, replay.lockstep);
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-replay", [&] {
    rf::serviceConfig(options);
    rf::Service service("replay", options);
    rf::ReplayNode node(service, replay);
    service.start();
    node.awaitServices();
    node.play();
    return static_cast<int>(rf::kExitStopped);
  });
}
