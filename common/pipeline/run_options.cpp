// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/run_options.hpp"

#include <cmath>
#include <filesystem>

namespace rf {
namespace {

std::string priorFile(const std::string& option, const std::string& input, const char* fallback) {
  if (option == "none") return {};
  if (!option.empty() || input.empty()) return option;
  const std::filesystem::path candidate = std::filesystem::path(input) / fallback;
  return std::filesystem::exists(candidate) ? candidate.string() : std::string();
}

std::string missingFile(const char* option, const std::string& path) {
  if (path.empty() || path == "none" || std::filesystem::exists(path)) return {};
  return std::string(option) + " = '" + path + "': no such file";
}

}  // namespace

std::string RunOptions::robotFolder() const {
  if (robot == "none") return {};
  if (!robot.empty() || input.empty()) return robot;
  const std::filesystem::path candidate = std::filesystem::path(input) / "robot";
  return std::filesystem::is_directory(candidate) ? candidate.string() : std::string();
}

std::string RunOptions::cameraPriorFile() const {
  if (robotGivesCamera()) return {};
  return priorFile(camera_prior, input, "odometry.txt");
}

std::string RunOptions::objectPriorFile() const {
  if (robotGivesObject()) return {};
  return priorFile(object_prior, input, "object_odometry.txt");
}

std::string RunOptions::problem() const {
  if (input.empty() == device.empty())
    return "--input: a folder or file is required (or a --device)";
  if (device.empty() && !std::filesystem::exists(input))
    return "--input = '" + input + "': no such file or folder";
  if (output.empty()) return "--output: a folder is required";
  if (threads < 1 || threads > 64)
    return "--threads = " + std::to_string(threads) + ": must be 1..64";
  if (!simulate_drift.empty() && simulate_drift.size() != 2 && simulate_drift.size() != 4) {
    return "--simulate-drift: give V,W (camera) or V,W,V,W (camera, object), got " +
           std::to_string(simulate_drift.size()) + " numbers";
  }
  for (const double d : simulate_drift) {
    if (!std::isfinite(d) || d < 0)
      return "--simulate-drift = " + std::to_string(d) + ": must be >= 0";
  }
  if (!simulate_drift.empty() && robotGivesCamera()) {
    return "--simulate-drift: drifts prior files, but " + robotFolder() +
           " gives the camera's prior; give --camera-prior, or --robot none";
  }
  for (const auto& [option, path] : {std::pair{"--camera-prior", camera_prior},
                                     {"--object-prior", object_prior},
                                     {"--robot", robot},
                                     {"--calibration", calibration},
                                     {"--config", config}}) {
    if (std::string text = missingFile(option, path); !text.empty()) return text;
  }
  return {};
}

}  // namespace rf
