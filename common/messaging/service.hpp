// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "messaging/bus.hpp"
#include "messaging/conversions.hpp"
#include "messaging/inbox.hpp"
#include "messaging/monitor.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace rf {

/// Exit codes of every service.
enum ExitCode : int {
  kExitStopped = 0,
  kExitFailed = 1,      ///< something that no rule foresaw
  kExitBadOptions = 2,  ///< arguments or configuration
  kExitNoLcm = 3,
  kExitNoInput = 4,  ///< no device, no file, or nothing usable in it
};

/// No device or input: exit code 4.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Options that every service has.
struct ServiceOptions {
  std::string config;            ///< YAML file, empty = defaults
  std::vector<std::string> set;  ///< overrides, section.key=value
  std::string bulk_in = kDefaultBulkUrl;
  std::string bulk_out;  ///< empty: bulk_in, or the default when that is a file
  std::string state_in = kDefaultStateUrl;
  std::string state_out;  ///< empty: state_in, or the default when that is a file
  bool lockstep = false;
};

void addServiceOptions(CLI::App& app, ServiceOptions& options);

/// SIGINT and SIGTERM set a flag from now on.
void catchStopSignals();
bool stopSignalled();

enum class Side { kBulk, kState };

/// What the five services share: the two buses, the inbox, heartbeat, commands and a log that
/// repeats nothing more than once a second. One worker thread uses it.
class Service {
 public:
  /// `name`: "capture", "prior", "segment", "fuse", "record". Throws BusError.
  Service(const std::string& name, const ServiceOptions& options);
  ~Service();

  /// Before start(). `live`: what a full mailbox does when the input is not a file (files wait).
  Inbox::Box listen(Side side, const std::string& channel_regex, std::size_t capacity,
                    Overflow live = Overflow::kDropOldest);
  /// Buses and heartbeat run, state "waiting": the ready message.
  void start();
  /// State "stopping" goes out, the buses end.
  void stop();

  /// False once a signal or a STOP command came, or every input file is delivered and read.
  bool running();
  /// Waits until something new is in a mailbox, at most this long.
  void wait(std::chrono::milliseconds timeout) { inbox_.waitForNews(timeout); }

  /// The next valid value of a mailbox; what does not decode is logged, counted and dropped.
  template <class Message>
  auto take(Inbox::Box box) {
    using Out = typename decltype(unpack<Message>(ByteView{}).value)::value_type;
    std::optional<std::pair<Out, std::chrono::steady_clock::time_point>> taken;
    while (auto raw = inbox_.pop(box)) {
      auto value = unpack<Message>(raw->bytes);
      if (value) {
        taken.emplace(std::move(*value), raw->arrival);
        break;
      }
      badInput(raw->channel + ": " + value.error);
    }
    return taken;
  }
  std::optional<RawMessage> takeRaw(Inbox::Box box) { return inbox_.pop(box); }
  /// Commands for this service other than STOP, in order.
  std::vector<Command> commands();

  /// Sends; a failure is logged and counted, never fatal. False when it was refused.
  bool send(Side side, const std::string& channel, const Bytes& bytes);

  /// Counts, logs (once a second at most).
  void badInput(const std::string& why);
  void warn(const std::string& text);
  void info(const std::string& text);
  void setState(ServiceState state, const std::string& text);

  Monitor& monitor() { return monitor_; }
  const std::string& name() const { return name_; }

 private:
  Bus& bus(Side side) { return side == Side::kBulk ? *bulk_ : *state_; }
  void heartbeat();
  void sendStatus();
  bool inputsEnded() const;

  std::string name_;
  Monitor monitor_;
  Inbox inbox_;
  std::shared_ptr<Bus> bulk_;
  std::shared_ptr<Bus> state_;
  Inbox::Box command_box_ = 0;
  bool stop_commanded_ = false;
  bool input_is_file_ = false;
  std::vector<Command> pending_commands_;

  std::mutex heartbeat_mutex_;
  std::condition_variable heartbeat_wake_;
  bool heartbeat_now_ = false;
  bool heartbeat_stop_ = false;
  std::thread heartbeat_thread_;
  Monitor::Clock::time_point last_warning_;
  std::int64_t suppressed_ = 0;
};

/// Runs a service's body with the signals caught and turns exceptions into messages on stderr and
/// exit codes. `body` gets the parsed options and returns an exit code.
int runService(const std::string& program, const std::function<int()>& body);

/// Parses; returns an exit code when the program should leave at once (--help, bad arguments).
std::optional<int> parseOptions(CLI::App& app, int argc, char** argv);

}  // namespace rf
