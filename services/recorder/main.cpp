// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>

#include "messaging/service_config.hpp"
#include "record_node.hpp"

namespace {

int run(const rf::ServiceOptions& options, const rf::RecordOptions& record) {
  rf::serviceConfig(options);  // so that a bad file is an error here too
  rf::Service service("record", options);
  rf::RecordNode node(service, record, options.bulk_in == options.state_in);
  service.start();
  while (service.running()) {
    if (!node.step()) service.wait(std::chrono::milliseconds(20));
  }
  node.finish();
  return rf::kExitStopped;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-record: writes both buses to a standard LCM event log, for lcm-logplayer and rf-replay");
  rf::ServiceOptions options;
  rf::RecordOptions record;
  rf::addServiceOptions(app, options);
  app.add_option("--output", record.output, "log file; an existing one is replaced")->required();
  app.add_option("--channels", record.channels, "regular expression of channels, whole name")
      ->capture_default_str();
  app.add_option("--split-mb", record.split_mb,
                 "begin a new file after this many megabytes; 0: never")
      ->check(CLI::Range(0, 1000000));
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-record", [&] { return run(options, record); });
}
