// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <rigidfusion/service_status_t.hpp>
#include <string>
#include <vector>

#include "values/segmentation_result.hpp"

namespace rf {

/// As stages and latencies are reported.
inline double milliseconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::milli>(d).count();
}

/// service_status_t's states.
enum class ServiceState : std::int32_t {
  kInit = 0,
  kWaiting = 1,
  kRunning = 2,
  kDegraded = 3,
  kError = 4,
  kStopping = 5,
  kFinished = 6,
};

/// Counts and times what a service does, for its heartbeat. Thread-safe.
class Monitor {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Monitor(std::string service);

  void input();
  /// One result: its frame, the milliseconds of work, the milliseconds since its last input
  /// arrived.
  void output(std::int64_t seq, double proc_ms, double latency_ms, const StageTimes& stages = {});
  void resent();
  void lost(std::int64_t frames);
  void dropped(std::int64_t messages);
  void bad();
  void setState(ServiceState state, const std::string& text);

  ServiceState state() const;
  std::string stateText() const;
  std::int64_t outputs() const;
  std::int64_t bads() const;
  std::int64_t losses() const;

  /// The heartbeat's content, but for the queue members. `wall_utime`: now, microseconds since the
  /// epoch.
  rigidfusion::service_status_t status(std::int64_t wall_utime);

 private:
  struct Window {
    std::deque<double> values;
    void add(double value);
    double mean() const;
    double max() const;
    double quantile(double q) const;
  };

  mutable std::mutex mutex_;
  rigidfusion::service_status_t total_;
  Clock::time_point last_input_;
  Clock::time_point rate_since_;
  std::int64_t rate_in_ = 0;
  std::int64_t rate_out_ = 0;
  double cpu_seconds_ = 0;
  long kernel_errors_at_start_ = 0;
  Window proc_;
  Window latency_;
  std::vector<std::string> stage_names_;
  std::map<std::string, Window> stages_;
};

/// Microseconds since the epoch; for heartbeats and log stamps only, never compared with a utime.
std::int64_t wallUtime();

}  // namespace rf
