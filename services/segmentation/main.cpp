// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "geometry/parallel.hpp"
#include "messaging/service_config.hpp"
#include "segment_node.hpp"

namespace {

int run(const rf::ServiceOptions& options, const rf::SegmentOptions& segment, int threads) {
  rf::setThreads(threads);
  const rf::PipelineConfig config = rf::serviceConfig(options);
  rf::Service service("segment", options);
  rf::SegmentNode node(service, config.segmentation, segment, options.lockstep);
  service.start();
  while (service.running()) {
    if (!node.step()) service.wait(std::chrono::milliseconds(5));
  }
  return rf::kExitStopped;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-segment: splits each frame into the static world and one moving body, and finds both "
      "motions");
  rf::ServiceOptions options;
  rf::SegmentOptions segment;
  int threads = 2;
  rf::addServiceOptions(app, options);
  app.add_option("--channel", segment.frame_channel, "frames")->capture_default_str();
  app.add_option("--prior-wait-ms", segment.prior_wait_ms,
                 "how long a frame waits for its prior (default: 2000 in lockstep, 50 live)")
      ->check(CLI::Range(0, 60000));
  app.add_option("--state-wait-ms", segment.state_wait_ms,
                 "lockstep: how long a frame waits for the model state before it (default: 4000)")
      ->check(CLI::Range(0, 60000));
  app.add_option("--threads", threads, "worker threads; results do not depend on it")
      ->check(CLI::Range(1, 64));
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-segment", [&] { return run(options, segment, threads); });
}
