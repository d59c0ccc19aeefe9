// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace rf {

/// A message as it arrived, not yet decoded.
struct RawMessage {
  std::string channel;
  std::vector<std::uint8_t> bytes;
  std::chrono::steady_clock::time_point arrival;
};

/// What a full mailbox does with one message more.
enum class Overflow {
  kDropOldest,  ///< live input: the oldest gives way and is counted
  kSupersede,   ///< heartbeats and states: the oldest gives way and nothing is lost, not counted
  kWait,        ///< files: the reader waits until there is room
};

/// Bounded mailboxes between receive threads, which push, and one worker, which waits and pops.
/// Thread-safe.
class Inbox {
 public:
  using Box = std::size_t;

  /// Adds a mailbox; before any push. capacity >= 1.
  Box addBox(std::size_t capacity, Overflow overflow = Overflow::kDropOldest);

  void push(Box box, RawMessage message);
  std::optional<RawMessage> pop(Box box);
  /// Until a message is in any box that was not there at the last call, or the time is over, or the
  /// inbox is closed. True when there is something new.
  bool waitForNews(std::chrono::milliseconds timeout);
  /// Wakes every waiter; later pushes are ignored.
  void close();

  /// Messages that gave way in mailboxes of kDropOldest.
  std::int64_t dropped() const;
  std::size_t depth() const;
  std::size_t capacity() const;

 private:
  struct Mailbox {
    std::size_t capacity;
    Overflow overflow;
    std::deque<RawMessage> messages;
  };

  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::condition_variable room_;
  std::vector<Mailbox> boxes_;
  std::int64_t pushed_ = 0;
  std::int64_t seen_ = 0;
  std::int64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace rf
