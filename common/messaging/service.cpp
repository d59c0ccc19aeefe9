// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/service.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdlib>

#include "config/yaml.hpp"
#include "datasets/error.hpp"
#include "kinematics/error.hpp"

namespace rf {
namespace {

constexpr auto kHeartbeat = std::chrono::milliseconds(500);
constexpr auto kWarningGap = std::chrono::seconds(1);
constexpr std::int8_t kSystemStatusId = 30;

volatile std::sig_atomic_t g_stop = 0;  // NOLINT: a signal handler can reach nothing else

void onSignal(int /*signal*/) { g_stop = 1; }

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string outUrl(const std::string& out, const std::string& in, const char* fallback) {
  if (!out.empty()) return out;
  return filePathOf(in).empty() ? in : std::string(fallback);
}

}  // namespace

void addServiceOptions(CLI::App& app, ServiceOptions& options) {
  app.add_option("--config", options.config, "configuration file (YAML), see rf-run --help");
  app.add_option("--set", options.set, "override one value: section.key=value (repeatable)");
  app.add_option("--bulk-in", options.bulk_in,
                 "URL that images come from; file:///LOG reads an LCM log")
      ->capture_default_str();
  app.add_option("--bulk-out", options.bulk_out,
                 "URL that images and model chunks go to (default: --bulk-in)");
  app.add_option("--state-in", options.state_in,
                 "URL that everything else comes from; file:///LOG too")
      ->capture_default_str();
  app.add_option("--state-out", options.state_out,
                 "URL that everything else goes to (default: --state-in)");
  app.add_flag("--lockstep,!--live", options.lockstep,
               "wait for every input of a frame and drop nothing; default: live, the newest wins");
  app.footer(
      "Exit codes: 0 stopped, 1 failed, 2 bad arguments or configuration, 3 no LCM, 4 no device or "
      "input.\n"
      "SIGINT and SIGTERM stop cleanly. The heartbeat is RF_STATUS_<SERVICE>, 2 Hz.");
}

void catchStopSignals() {
  struct sigaction action {};
  action.sa_handler = onSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

bool stopSignalled() { return g_stop != 0; }

Service::Service(const std::string& name, const ServiceOptions& options)
    : name_(name), monitor_(name) {
  const std::string bulk_out = outUrl(options.bulk_out, options.bulk_in, kDefaultBulkUrl);
  const std::string state_out = outUrl(options.state_out, options.state_in, kDefaultStateUrl);
  bulk_ = std::make_shared<Bus>(options.bulk_in, bulk_out);
  const bool same = options.bulk_in == options.state_in && bulk_out == state_out;
  state_ = same ? bulk_ : std::make_shared<Bus>(options.state_in, state_out);
  input_is_file_ = !filePathOf(options.bulk_in).empty() || !filePathOf(options.state_in).empty();
  if (!bulk_->warnings().empty()) spdlog::warn("{}", bulk_->warnings());
  command_box_ = listen(Side::kState, "RF_COMMAND", 64);
}

Service::~Service() { stop(); }

Inbox::Box Service::listen(Side side, const std::string& channel_regex, std::size_t capacity,
                           Overflow live) {
  const auto overflow = bus(side).liveInput() ? live : Overflow::kWait;
  const auto box = inbox_.addBox(capacity, overflow);
  bus(side).subscribe(channel_regex, inbox_, box);
  return box;
}

void Service::start() {
  bulk_->start();
  if (state_ != bulk_) state_->start();
  monitor_.setState(ServiceState::kWaiting, "ready, waiting for input");
  heartbeat_thread_ = std::thread([this] { heartbeat(); });
  spdlog::info("ready");
}

void Service::stop() {
  if (!heartbeat_thread_.joinable()) return;
  if (monitor_.state() != ServiceState::kFinished)
    monitor_.setState(ServiceState::kStopping, "stopping");
  {
    const std::lock_guard lock(heartbeat_mutex_);
    heartbeat_stop_ = true;
    heartbeat_wake_.notify_all();
  }
  heartbeat_thread_.join();
  sendStatus();
  inbox_.close();
  bulk_->stop();
  if (state_ != bulk_) state_->stop();
  const auto s = monitor_.status(wallUtime());
  spdlog::info("stopped: {} in, {} out, {} lost, {} dropped, {} bad, {} resent", s.n_in, s.n_out,
               s.n_lost_seq, s.n_dropped_queue + inbox_.dropped(), s.n_bad_input, s.n_resent);
}

bool Service::inputsEnded() const {
  return input_is_file_ && (bulk_->liveInput() || bulk_->inputEnded()) &&
         (state_->liveInput() || state_->inputEnded()) && inbox_.depth() == 0;
}

bool Service::running() {
  while (auto command = take<rigidfusion::command_t>(command_box_)) {
    Command& c = command->first;
    if (!c.target.empty() && c.target != name_) continue;
    if (c.kind == CommandKind::kStop)
      stop_commanded_ = true;
    else
      pending_commands_.push_back(std::move(c));
  }
  for (const auto& bus : {bulk_, state_}) {
    if (const auto error = bus->receiveError(); !error.empty()) throw BusError(error);
  }
  return !stopSignalled() && !stop_commanded_ && !inputsEnded();
}

std::vector<Command> Service::commands() { return std::exchange(pending_commands_, {}); }

bool Service::send(Side side, const std::string& channel, const Bytes& bytes) {
  const std::string problem = bus(side).publish(channel, bytes);
  if (problem.empty()) return true;
  warn(problem);
  setState(ServiceState::kDegraded, problem);
  return false;
}

void Service::badInput(const std::string& why) {
  monitor_.bad();
  warn("dropped: " + why);
}

void Service::warn(const std::string& text) {
  const auto now = Monitor::Clock::now();
  if (now - last_warning_ < kWarningGap) {
    ++suppressed_;
    return;
  }
  if (suppressed_ > 0) spdlog::warn("({} warnings were not shown)", suppressed_);
  suppressed_ = 0;
  last_warning_ = now;
  spdlog::warn("{}", text);
}

void Service::info(const std::string& text) { spdlog::info("{}", text); }

void Service::setState(ServiceState state, const std::string& text) {
  if (monitor_.state() == state) return;
  monitor_.setState(state, text);
  const std::lock_guard lock(heartbeat_mutex_);
  heartbeat_now_ = true;
  heartbeat_wake_.notify_all();
}

void Service::sendStatus() {
  auto status = monitor_.status(wallUtime());
  status.n_dropped_queue += inbox_.dropped();
  status.queue_depth = static_cast<std::int32_t>(inbox_.depth());
  status.queue_capacity = static_cast<std::int32_t>(inbox_.capacity());
  state_->publish("RF_STATUS_" + upper(name_), encodeMessage(status));
}

void Service::heartbeat() {
  auto last_state = ServiceState::kInit;
  for (;;) {
    sendStatus();
    if (const auto state = monitor_.state(); state != last_state) {
      last_state = state;
      bot_core::system_status_t line{};
      line.utime = wallUtime();
      line.system = kSystemStatusId;
      line.importance = state == ServiceState::kError      ? 2
                        : state == ServiceState::kDegraded ? 1
                                                           : 0;
      line.value = "rf-" + name_ + ": " + monitor_.stateText();
      state_->publish("SYSTEM_STATUS", encodeMessage(line));
    }
    std::unique_lock lock(heartbeat_mutex_);
    heartbeat_wake_.wait_for(lock, kHeartbeat, [&] { return heartbeat_stop_ || heartbeat_now_; });
    if (heartbeat_stop_) return;
    heartbeat_now_ = false;
  }
}

std::optional<int> parseOptions(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitStopped : kExitBadOptions;
  }
}

int runService(const std::string& program, const std::function<int()>& body) {
  auto logger = spdlog::stderr_logger_mt(program);
  logger->set_pattern("%H:%M:%S.%e %n %l: %v");
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
  catchStopSignals();
  try {
    return body();
  } catch (const ConfigError& e) {
    spdlog::error("{}", e.what());
    return kExitBadOptions;
  } catch (const std::invalid_argument& e) {
    spdlog::error("{}", e.what());
    return kExitBadOptions;
  } catch (const KinematicsError& e) {
    spdlog::error("{}", e.what());
    return kExitBadOptions;
  } catch (const BusError& e) {
    spdlog::error("{}", e.what());
    return kExitNoLcm;
  } catch (const InputError& e) {
    spdlog::error("{}", e.what());
    return kExitNoInput;
  } catch (const DatasetError& e) {
    spdlog::error("{}", e.what());
    return kExitNoInput;
  } catch (const std::exception& e) {
    spdlog::error("{}", e.what());
    return kExitFailed;
  }
}

}  // namespace rf
