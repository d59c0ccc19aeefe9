// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "fuse_node.hpp"
#include "geometry/parallel.hpp"
#include "messaging/service_config.hpp"

namespace {

int run(const rf::ServiceOptions& options, const rf::FuseOptions& fuse, int threads) {
  rf::setThreads(threads);
  const rf::PipelineConfig config = rf::serviceConfig(options);
  rf::Service service("fuse", options);
  rf::FuseNode node(service, config, fuse, options.lockstep);
  service.start();
  while (service.running()) {
    if (!node.step()) service.wait(std::chrono::milliseconds(5));
  }
  while (node.step()) {
  }
  node.finish();
  return rf::kExitStopped;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-fuse: fuses surfel models of the static world and of the moving body, and tracks against "
      "them");
  rf::ServiceOptions options;
  rf::FuseOptions fuse;
  int threads = 2;
  rf::addServiceOptions(app, options);
  app.add_option("--output", fuse.output,
                 "result folder, written as frames come; models at every stop and SAVE");
  app.add_flag("--write-masks", fuse.write_masks, "write masks/<timestamp>.png");
  app.add_option("--channel", fuse.frame_channel, "frames")->capture_default_str();
  app.add_option("--camera-pose-channel", fuse.camera_pose_channel,
                 "T_WC as bot_core.pose_t; '' for none")
      ->capture_default_str();
  app.add_option("--object-pose-channel", fuse.object_pose_channel,
                 "T_WO as bot_core.pose_t; '' for none")
      ->capture_default_str();
  app.add_option(
         "--frame-wait-ms", fuse.frame_wait_ms,
         "how long a segmentation waits for its frame (default: 10000 in lockstep, 200 live)")
      ->check(CLI::Range(0, 60000));
  app.add_option("--threads", threads, "worker threads; results do not depend on it")
      ->check(CLI::Range(1, 64));
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-fuse", [&] { return run(options, fuse, threads); });
}
