// SPDX-License-Identifier: BSD-3-Clause
// rf-launch: the five processes over LCM on one machine, with the options of rf-run.
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>

#include "child.hpp"
#include "messaging/net_check.hpp"
#include "messaging/service.hpp"
#include "options/effective.hpp"
#include "options/run_cli.hpp"
#include "plan.hpp"
#include "watch.hpp"

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr auto kReadyTime = seconds(30);
constexpr auto kListenFirst = milliseconds(700);  ///< heartbeats come every 500 ms
constexpr auto kIdleEnd =
    milliseconds(2000);  ///< realtime: no result for this long after the last frame
constexpr auto kStopTime = seconds(60);

std::string ownFolder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

/// Throws when a child has ended that should run.
void expectRunning(std::vector<rf::Child>& children) {
  for (rf::Child& child : children) {
    if (const auto code = child.exitCode()) {
      throw std::runtime_error(
          fmt::format("rf-{} ended early with exit code {}; its last words:\n{}", child.name(),
                      *code, child.logTail()));
    }
  }
}

void refuseCrowdedBus(rf::Watch& watch, const rf::LaunchOptions& options) {
  const auto until = Clock::now() + kListenFirst;
  while (Clock::now() < until) watch.update(milliseconds(50));
  for (const auto& [service, status] : watch.statuses()) {
    throw std::invalid_argument(
        fmt::format("--port = {}: rf-{} (process {}) already talks there; give another",
                    options.port, service, status.pid));
  }
}

void awaitReady(rf::Watch& watch, std::vector<rf::Child>& children) {
  const auto until = Clock::now() + kReadyTime;
  const auto all = [&] {
    return std::all_of(children.begin(), children.end(),
                       [&](const rf::Child& c) { return watch.ready(c.name()); });
  };
  while (!all() && !rf::stopSignalled()) {
    watch.update(milliseconds(50));
    expectRunning(children);
    if (Clock::now() > until)
      throw std::runtime_error("the services did not become ready within 30 s");
  }
}

void showProgress(const rf::Watch& watch, std::size_t total, bool quiet) {
  static Clock::time_point last;
  if (quiet || Clock::now() - last < milliseconds(200)) return;
  last = Clock::now();
  const auto fuse = watch.statuses().find("fuse");
  const double rate = fuse == watch.statuses().end() ? 0 : fuse->second.rate_out_hz;
  const std::string of = total > 0 ? fmt::format("/{}", total) : "";
  fmt::print(stderr, "\r  frame {}{}  {:.1f} Hz  {:<40}", watch.lastSeq() + 1, of, rate,
             watch.lastResult());
}

/// Until capture has ended and, in real time, results stop coming. Returns capture's exit code.
int awaitEnd(rf::Watch& watch, rf::Child& capture, std::vector<rf::Child>& receivers,
             std::size_t total, const rf::LaunchOptions& options) {
  auto last_news = Clock::now();
  std::int64_t results = 0;
  while (!rf::stopSignalled()) {
    watch.update(milliseconds(50));
    expectRunning(receivers);
    showProgress(watch, total, options.run.quiet);
    if (watch.results() != results) last_news = Clock::now();
    results = watch.results();
    if (const auto code = capture.exitCode()) {
      if (!options.realtime || *code != 0 || Clock::now() - last_news > kIdleEnd) return *code;
    }
  }
  return rf::kExitStopped;
}

/// Sum over the services of what went wrong, as one line.
std::string losses(const rf::Watch& watch) {
  std::string out;
  for (const auto& [service, s] : watch.statuses()) {
    const std::int64_t worst = s.n_lost_seq + s.n_dropped_queue + s.n_bad_input + s.n_resent;
    if (worst == 0) continue;
    out += fmt::format("  rf-{}: {} lost, {} dropped, {} bad inputs, {} sent again\n", service,
                       s.n_lost_seq, s.n_dropped_queue, s.n_bad_input, s.n_resent);
  }
  return out;
}

int launch(const rf::LaunchOptions& options) {
  // A bad configuration or robot shows before anything starts.
  const rf::PipelineConfig config = rf::effectiveConfig(options.run);
  std::vector<std::string> remarks;
  rf::makePriorStage(config.prior, options.run, remarks);
  const bool from_device = !options.run.device.empty();
  const std::size_t total = from_device ? 0 : rf::openSource(options.run)->size();
  const auto network = rf::checkNetwork();
  if (!network.problems.empty()) fmt::print(stderr, "{}", network.text());
  if (!network.usable()) return rf::kExitNoLcm;
  std::filesystem::create_directories(options.run.output + "/logs");

  rf::Watch watch(options.stateUrl());
  refuseCrowdedBus(watch, options);
  std::vector<rf::Child> receivers;
  for (const auto& planned : rf::planReceivers(options)) {
    receivers.emplace_back(planned.service, planned.arguments, options.logPath(planned.service));
  }
  awaitReady(watch, receivers);
  const auto planned = rf::planCapture(options);
  rf::Child capture(planned.service, planned.arguments, options.logPath(planned.service));
  const auto start = Clock::now();
  const int code = awaitEnd(watch, capture, receivers, total, options);
  const double took = std::chrono::duration<double>(Clock::now() - start).count();
  capture.askToStop();
  capture.waitFor(kStopTime);
  int worst = code;
  for (rf::Child& child : receivers) {  // the recorder last: it hears the others stop
    child.askToStop();
    const int ended = child.waitFor(kStopTime);
    watch.update(milliseconds(50));
    if (ended != 0) {
      fmt::print(stderr, "\nrf-{} ended with exit code {}; its last words:\n{}", child.name(),
                 ended, child.logTail());
      if (worst == 0) worst = ended;
    }
  }
  if (code != 0)
    fmt::print(stderr, "\nrf-capture ended with exit code {}; its last words:\n{}", code,
               capture.logTail());
  rf::savePriors(options.run);
  if (!options.run.quiet) {
    const auto of = total > 0 ? static_cast<std::int64_t>(total) : watch.lastSeq() + 1;
    fmt::print(stderr, "\n{} of {} frames in {:.1f} s; results in {}\n{}", watch.results(), of,
               took, options.run.output, losses(watch));
  }
  return worst;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-launch: segment, track and reconstruct a recording with five processes over LCM: "
      "rf-capture, rf-prior,\n"
      "rf-segment, rf-fuse, rf-record. In lockstep, unless --realtime: same results as rf-run, "
      "byte for byte.");
  rf::LaunchOptions options;
  options.bin_dir = ownFolder();
  rf::addRunOptions(app, options.run);
  app.add_option(
      "--device", options.run.device,
      "instead of --input: map live from an OpenNI2 device, by URI or 'any', until Ctrl-C");
  app.add_flag("--realtime", options.realtime, "play at the recorded rate; frames may be skipped");
  app.add_option("--speed", options.speed, "with --realtime: times the recorded rate")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 100.0));
  app.add_option("--port", options.port,
                 "UDP port of the bulk bus; the state bus is on the next one")
      ->capture_default_str()
      ->check(CLI::Range(1024, 65534));
  app.add_option("--timeout-ms", options.timeout_ms,
                 "lockstep: a frame without result is sent again after this")
      ->capture_default_str()
      ->check(CLI::Range(10, 600000));
  app.add_flag("--no-record", options.no_record, "do not write recording.lcm");
  app.footer(
      "Exit codes: 0 done or stopped, 1 failed, 2 bad arguments or configuration, 3 no LCM, 4 no "
      "input.");
  if (const auto code = rf::parseOptions(app, argc, argv)) return *code;
  return rf::runService("rf-launch", [&] {
    if (const auto problem = options.run.problem(); !problem.empty())
      throw std::invalid_argument(problem);
    if (!options.run.device.empty()) options.realtime = true;
    return launch(options);
  });
}
