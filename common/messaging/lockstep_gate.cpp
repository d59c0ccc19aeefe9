// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/lockstep_gate.hpp"

#include <CLI/CLI.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <stdexcept>

namespace rf {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr int kUnansweredLimit = 3;

}  // namespace

void addLockstepOptions(CLI::App& app, LockstepOptions& options) {
  app.add_option("--await-seconds", options.await_seconds,
                 "how long to wait for the services of --await")
      ->capture_default_str()
      ->check(CLI::Range(1, 3600));
  app.add_option("--timeout-ms", options.timeout_ms,
                 "lockstep: a frame without result is sent again after this")
      ->capture_default_str()
      ->check(CLI::Range(10, 600000));
  app.add_option("--resends", options.resends, "lockstep: how often, before the frame is given up")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000));
}

LockstepGate::LockstepGate(Service& service, const LockstepOptions& options)
    : service_(service),
      options_(options),
      states_(service.listen(Side::kState, "RF_MODEL_STATE", 16, Overflow::kSupersede)),
      statuses_(service.listen(Side::kState, "RF_STATUS_.*", 64, Overflow::kSupersede)) {}

void LockstepGate::awaitServices() {
  std::set<std::string> missing(options_.await.begin(), options_.await.end());
  const auto deadline = Clock::now() + std::chrono::seconds(options_.await_seconds);
  while (!missing.empty() && service_.running()) {
    while (const auto raw = service_.takeRaw(statuses_)) {
      const auto status = decodeMessage<rigidfusion::service_status_t>(raw->bytes);
      const bool ready = status && status->state >= rigidfusion::service_status_t::WAITING &&
                         status->state <= rigidfusion::service_status_t::DEGRADED;
      if (ready) missing.erase(status->service);
    }
    if (missing.empty()) return;
    if (Clock::now() > deadline) {
      throw InputError(fmt::format(
          "no ready message from {} within {} s: are they running on the same --state-in?",
          fmt::join(missing, ", "), options_.await_seconds));
    }
    service_.wait(kPoll);
  }
}

bool LockstepGate::resultArrived(std::int64_t utime) {
  while (const auto state = service_.take<rigidfusion::model_state_t>(states_)) {
    if (state->first.utime == utime) return true;
  }
  return false;
}

bool LockstepGate::awaitResult(std::int64_t utime, std::int64_t seq,
                               const std::function<void()>& resend,
                               const std::function<void()>& idle) {
  for (int sent = 1;; ++sent) {
    const auto deadline = Clock::now() + std::chrono::milliseconds(options_.timeout_ms);
    while (service_.running() && Clock::now() < deadline) {
      if (resultArrived(utime)) {
        unanswered_ = 0;
        return true;
      }
      service_.wait(kPoll);
      if (idle) idle();
    }
    if (!service_.running()) return true;
    if (sent > options_.resends) break;
    service_.warn(
        fmt::format("frame {}: no RF_MODEL_STATE within {} ms, sending it again ({} of {})", seq,
                    options_.timeout_ms, sent, options_.resends));
    service_.monitor().resent();
    resend();
  }
  service_.warn(fmt::format("frame {}: given up after {} times", seq, options_.resends + 1));
  service_.monitor().lost(1);
  service_.setState(ServiceState::kDegraded, "no answer from fusion");
  if (++unanswered_ >= kUnansweredLimit) {
    throw std::runtime_error(
        fmt::format("{} frames in a row got no RF_MODEL_STATE; giving up", unanswered_));
  }
  return false;
}

void LockstepGate::discard() {
  while (service_.takeRaw(states_)) {
  }
  while (service_.takeRaw(statuses_)) {
  }
}

}  // namespace rf
