// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pipeline/run_options.hpp"

namespace rf {

/// What rf-launch is asked for beyond the options of rf-run.
struct LaunchOptions {
  RunOptions run;
  bool realtime = false;
  double speed = 1;  ///< realtime: times the recorded rate
  int port = 7667;   ///< bulk; the state bus is on the next one
  std::string host_group = "239.255.76.67";
  bool no_record = false;
  int timeout_ms = 10000;  ///< lockstep: a frame without result is sent again after this
  std::string bin_dir;     ///< where the services are

  std::string bulkUrl() const;
  std::string stateUrl() const;
  std::string logPath(const std::string& service) const;
};

/// A service to start: its name ("capture", ...) and command line.
struct PlannedChild {
  std::string service;
  std::vector<std::string> arguments;
};

/// The four services that wait for frames, in the order in which to start (and stop) them.
std::vector<PlannedChild> planReceivers(const LaunchOptions& options);
/// The service that plays the input.
PlannedChild planCapture(const LaunchOptions& options);

}  // namespace rf
