// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>

#include "messaging/bus.hpp"
#include "messaging/wire.hpp"

namespace rf {

/// Listens to the heartbeats and results on the state bus.
class Watch {
 public:
  /// Throws BusError.
  explicit Watch(const std::string& state_url);

  /// Takes what arrived, waiting at most this long for something.
  void update(std::chrono::milliseconds timeout);

  /// Newest heartbeat of each service.
  const std::map<std::string, rigidfusion::service_status_t>& statuses() const { return statuses_; }
  bool ready(const std::string& service) const;
  /// "camera tracked, object unborn" of the newest result; empty before the first.
  const std::string& lastResult() const { return last_result_; }
  std::int64_t lastSeq() const { return last_seq_; }
  std::int64_t results() const { return results_; }

 private:
  Inbox inbox_;
  Bus bus_;
  Inbox::Box status_box_;
  Inbox::Box state_box_;
  std::map<std::string, rigidfusion::service_status_t> statuses_;
  std::string last_result_;
  std::int64_t last_seq_ = -1;
  std::int64_t results_ = 0;
};

}  // namespace rf
