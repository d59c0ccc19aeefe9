// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "messaging/service.hpp"

namespace rf {

/// How a source of frames works in step with the services behind it.
struct LockstepOptions {
  std::vector<std::string> await;  ///< services that must be ready before the first frame
  int await_seconds = 30;
  int timeout_ms = 3000;  ///< how long a frame's result may take before the frame is sent again
  int resends = 10;       ///< how often, before the frame is given up
};

void addLockstepOptions(CLI::App& app, LockstepOptions& options);

/// Holds a source of frames back until RF_MODEL_STATE of the last frame has arrived.
class LockstepGate {
 public:
  /// Before service.start().
  LockstepGate(Service& service, const LockstepOptions& options);

  /// Waits until every awaited service sends heartbeats of a ready state. Throws InputError with
  /// the names of those that are missing.
  void awaitServices();

  /// Waits for the result of the frame; calls `resend` each time it takes too long and `idle` now
  /// and then. False when the frame had to be given up; a service that is being stopped gives true.
  /// Throws std::runtime_error when three frames in a row were given up.
  bool awaitResult(std::int64_t utime, std::int64_t seq, const std::function<void()>& resend,
                   const std::function<void()>& idle = {});
  /// Forgets results that arrived unasked (live play).
  void discard();

 private:
  bool resultArrived(std::int64_t utime);

  Service& service_;
  LockstepOptions options_;
  Inbox::Box states_;
  Inbox::Box statuses_;
  int unanswered_ = 0;
};

}  // namespace rf
