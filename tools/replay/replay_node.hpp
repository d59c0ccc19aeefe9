// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "messaging/lockstep_gate.hpp"
#include "messaging/log_file.hpp"
#include "messaging/service.hpp"

namespace rf {

struct ReplayOptions {
  std::string log;
  std::string channels = "OPENNI_FRAME|RF_CAMERA|RF_FRAME_TICK|RF_MOTION_PRIOR|POSE_.*";
  std::string frame_channel = "OPENNI_FRAME";
  double speed = 0;  ///< 0: lockstep; else times the recorded rate, without waiting for results
  LockstepOptions lockstep;
};

/// Publishes the inputs of a recording again. In lockstep frame k+1 goes out when RF_MODEL_STATE of
/// frame k has arrived; when that takes too long, everything since frame k is sent again.
class ReplayNode {
 public:
  /// Throws InputError when the log cannot be opened.
  ReplayNode(Service& service, const ReplayOptions& options);
  void awaitServices() { gate_.awaitServices(); }
  void play();

 private:
  using Clock = std::chrono::steady_clock;
  struct Frame {
    std::int64_t utime;
    std::int64_t seq;
  };

  /// The frame in an event of the frame channel; nothing when it does not decode.
  std::optional<Frame> frameIn(const LogEvent& event);
  void send(const LogEvent& event);
  void awaitLast();
  void pace(std::int64_t utime);

  Service& service_;
  ReplayOptions options_;
  std::regex channels_;
  LogReader log_;
  LockstepGate gate_;
  std::optional<Frame> last_;
  std::vector<LogEvent> since_last_;
  std::optional<LogEvent> camera_;
  Clock::time_point start_;
  std::optional<std::int64_t> first_utime_;
};

}  // namespace rf
