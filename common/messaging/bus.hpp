// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "messaging/inbox.hpp"

namespace rf {

inline constexpr const char* kDefaultBulkUrl = "udpm://239.255.76.67:7667?ttl=0";
inline constexpr const char* kDefaultStateUrl = "udpm://239.255.76.67:7668?ttl=0";

/// LCM cannot be used as asked: exit code 3. The text says what is missing and how to mend it.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The URL with recv_buf_size added when it is udpm and names none.
std::string withReceiveBuffer(const std::string& url, long bytes);
/// recv_buf_size of a URL, 0 when it names none.
long receiveBufferOf(const std::string& url);
/// Path of a file:// URL without its options; empty for other URLs.
std::string filePathOf(const std::string& url);

/// One bus: an LCM URL to receive from and one to send to, usually the same. Messages go from a
/// receive thread of its own straight to an inbox, undecoded. An in-URL file:///path reads an LCM
/// log as fast as the inbox takes it (?speed=S: at S times the recorded rate). publish may be
/// called from any thread.
class Bus {
 public:
  /// Throws BusError. `in_url` may be empty for a sender only, `out_url` for a receiver only.
  Bus(const std::string& in_url, const std::string& out_url);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Messages on channels that match the regular expression (whole name) go to `box` of `inbox`.
  /// Before start(). LCM's self-test may take up to 10 s here on a machine that blocks multicast.
  void subscribe(const std::string& channel_regex, Inbox& inbox, Inbox::Box box);
  void start();
  /// Ends the receive thread; no message is delivered afterwards.
  void stop();

  /// Empty when the message was handed to the kernel, else why not. A message that is larger than
  /// the receive buffer that the kernel grants is refused with a text that names the sysctl.
  std::string publish(const std::string& channel, const std::vector<std::uint8_t>& bytes);

  /// True when the input is a file and all of it was delivered.
  bool inputEnded() const { return input_ended_; }
  /// Empty, or why the receive thread ended early.
  std::string receiveError() const;
  /// True for a live URL, false for a file.
  bool liveInput() const;
  /// Warnings of opening it (a smaller receive buffer than asked), one per line.
  const std::string& warnings() const { return warnings_; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::atomic<bool> input_ended_ = false;
  std::string warnings_;
};

}  // namespace rf
