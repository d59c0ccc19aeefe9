// SPDX-License-Identifier: BSD-3-Clause
#include "plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace rf {
namespace {

using Arguments = std::vector<std::string>;

void add(Arguments& to, const Arguments& more) { to.insert(to.end(), more.begin(), more.end()); }

PlannedChild service(const LaunchOptions& options, const std::string& name) {
  PlannedChild child{name, {options.bin_dir + "/rf-" + name}};
  Arguments& a = child.arguments;
  add(a, {"--bulk-in", options.bulkUrl(), "--state-in", options.stateUrl()});
  if (!options.realtime) a.push_back("--lockstep");
  if (!options.run.config.empty()) add(a, {"--config", options.run.config});
  if (!options.run.mode.empty()) add(a, {"--set", "segmentation.mode=" + options.run.mode});
  for (const std::string& assignment : options.run.set) add(a, {"--set", assignment});
  return child;
}

PlannedChild prior(const LaunchOptions& options) {
  PlannedChild child = service(options, "prior");
  Arguments& a = child.arguments;
  if (const auto file = options.run.cameraPriorFile(); !file.empty()) add(a, {"--camera", file});
  if (const auto file = options.run.objectPriorFile(); !file.empty()) add(a, {"--object", file});
  if (const auto folder = options.run.robotFolder(); !folder.empty()) {
    add(a, {"--robot", folder});
    if (!options.run.robotGivesCamera()) a.push_back("--robot-no-camera");
    if (!options.run.robotGivesObject()) a.push_back("--robot-no-object");
  }
  if (!options.run.simulate_drift.empty()) {
    add(a, {"--simulate-drift", fmt::format("{}", fmt::join(options.run.simulate_drift, ",")),
            "--drift-seed", std::to_string(options.run.drift_seed)});
  }
  return child;
}

}  // namespace

std::string LaunchOptions::bulkUrl() const {
  return fmt::format("udpm://{}:{}?ttl=0", host_group, port);
}

std::string LaunchOptions::stateUrl() const {
  return fmt::format("udpm://{}:{}?ttl=0", host_group, port + 1);
}

std::string LaunchOptions::logPath(const std::string& service_name) const {
  return run.output + "/logs/rf-" + service_name + ".txt";
}

std::vector<PlannedChild> planReceivers(const LaunchOptions& options) {
  const std::string threads = std::to_string(options.run.threads);
  std::vector<PlannedChild> out;
  out.push_back(prior(options));
  out.push_back(service(options, "segment"));
  add(out.back().arguments, {"--threads", threads});
  out.push_back(service(options, "fuse"));
  add(out.back().arguments, {"--threads", threads, "--output", options.run.output});
  if (options.run.write_masks) out.back().arguments.push_back("--write-masks");
  if (!options.no_record) {
    out.push_back(service(options, "record"));
    add(out.back().arguments, {"--output", options.run.output + "/recording.lcm"});
  }
  return out;
}

PlannedChild planCapture(const LaunchOptions& options) {
  PlannedChild child = service(options, "capture");
  if (!options.run.calibration.empty())
    add(child.arguments, {"--calibration", options.run.calibration});
  if (!options.run.device.empty()) {
    add(child.arguments, {"--device", options.run.device});
    return child;
  }
  add(child.arguments,
      {"--input", options.run.input, "--await", "prior,segment,fuse", "--timeout-ms",
       std::to_string(options.timeout_ms), "--speed", fmt::format("{}", options.speed)});
  return child;
}

}  // namespace rf
