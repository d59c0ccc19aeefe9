// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/monitor.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <numeric>

#include "messaging/net_check.hpp"

namespace rf {
namespace {

constexpr std::size_t kWindow = 60;  ///< results that means and maxima look back on
constexpr std::size_t kMaxStages = 32;

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

double cpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double residentMb() {
  std::ifstream file("/proc/self/statm");
  long total = 0;
  long resident = 0;
  file >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data())
                                                        : std::string("?");
}

}  // namespace

std::int64_t wallUtime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void Monitor::Window::add(double value) {
  values.push_back(value);
  if (values.size() > kWindow) values.pop_front();
}

double Monitor::Window::mean() const {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Monitor::Window::max() const {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

double Monitor::Window::quantile(double q) const {
  if (values.empty()) return 0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

Monitor::Monitor(std::string service)
    : rate_since_(Clock::now()), kernel_errors_at_start_(kernelReceiveBufferErrors()) {
  total_ = {};
  total_.service = std::move(service);
  total_.host = hostName();
  total_.pid = getpid();
  total_.version = RF_VERSION;
  total_.start_utime = wallUtime();
  total_.state_text = "starting";
  total_.last_seq = -1;
  total_.last_input_age_ms = -1;
}

void Monitor::input() {
  const std::lock_guard lock(mutex_);
  ++total_.n_in;
  ++rate_in_;
  last_input_ = Clock::now();
}

void Monitor::output(std::int64_t seq, double proc_ms, double latency_ms,
                     const StageTimes& stages) {
  const std::lock_guard lock(mutex_);
  ++total_.n_out;
  ++rate_out_;
  total_.last_seq = seq;
  proc_.add(proc_ms);
  latency_.add(latency_ms);
  for (const auto& [name, ms] : stages) {
    if (!stages_.contains(name)) {
      if (stage_names_.size() >= kMaxStages) continue;
      stage_names_.push_back(name);
    }
    stages_[name].add(ms);
  }
}

void Monitor::resent() {
  const std::lock_guard lock(mutex_);
  ++total_.n_resent;
}

void Monitor::lost(std::int64_t frames) {
  const std::lock_guard lock(mutex_);
  total_.n_lost_seq += frames;
}

void Monitor::dropped(std::int64_t messages) {
  const std::lock_guard lock(mutex_);
  total_.n_dropped_queue += messages;
}

void Monitor::bad() {
  const std::lock_guard lock(mutex_);
  ++total_.n_bad_input;
}

void Monitor::setState(ServiceState state, const std::string& text) {
  const std::lock_guard lock(mutex_);
  total_.state = static_cast<std::int32_t>(state);
  total_.state_text = text;
}

ServiceState Monitor::state() const {
  const std::lock_guard lock(mutex_);
  return static_cast<ServiceState>(total_.state);
}

std::string Monitor::stateText() const {
  const std::lock_guard lock(mutex_);
  return total_.state_text;
}

std::int64_t Monitor::outputs() const {
  const std::lock_guard lock(mutex_);
  return total_.n_out;
}

std::int64_t Monitor::bads() const {
  const std::lock_guard lock(mutex_);
  return total_.n_bad_input;
}

std::int64_t Monitor::losses() const {
  const std::lock_guard lock(mutex_);
  return total_.n_lost_seq;
}

rigidfusion::service_status_t Monitor::status(std::int64_t wall_utime) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  const double elapsed = std::max(1e-3, std::chrono::duration<double>(now - rate_since_).count());
  const double cpu = cpuSeconds();
  total_.cpu_percent = 100 * (cpu - cpu_seconds_) / elapsed;
  total_.rate_in_hz = static_cast<double>(rate_in_) / elapsed;
  total_.rate_out_hz = static_cast<double>(rate_out_) / elapsed;
  cpu_seconds_ = cpu;
  rate_in_ = 0;
  rate_out_ = 0;
  rate_since_ = now;
  total_.utime = wall_utime;
  total_.rss_mb = residentMb();
  total_.kernel_rcvbuf_errors = kernelReceiveBufferErrors() - kernel_errors_at_start_;
  total_.proc_ms_mean = proc_.mean();
  total_.proc_ms_p95 = proc_.quantile(0.95);
  total_.proc_ms_max = proc_.max();
  total_.latency_ms_mean = latency_.mean();
  total_.latency_ms_max = latency_.max();
  if (total_.n_in > 0) {
    total_.last_input_age_ms = std::chrono::duration<double, std::milli>(now - last_input_).count();
  }
  total_.stage_name = stage_names_;
  total_.stage_ms_mean.clear();
  total_.stage_ms_max.clear();
  for (const std::string& name : stage_names_) {
    total_.stage_ms_mean.push_back(static_cast<float>(stages_[name].mean()));
    total_.stage_ms_max.push_back(static_cast<float>(stages_[name].max()));
  }
  total_.n_stages = static_cast<std::int16_t>(stage_names_.size());
  rigidfusion::service_status_t out = total_;
  ++total_.seq;
  return out;
}

}  // namespace rf
