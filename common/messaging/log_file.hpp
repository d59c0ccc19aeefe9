// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace rf {

/// One event of an LCM log.
struct LogEvent {
  std::int64_t number = 0;  ///< counts the events that were WRITTEN; does not show loss
  std::int64_t utime = 0;   ///< microseconds since the epoch: when the message was received
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Bounds of what a log may claim of an event.
inline constexpr std::size_t kMaxChannelName = 63;
inline constexpr std::size_t kMaxEventBytes = 64U << 20U;

/// Reads a standard LCM event log. Damage is skipped to the next sync word and counted; a truncated
/// tail ends the log. Nothing is allocated beyond the file's own size. Throws std::runtime_error
/// only when the file cannot be opened.
class LogReader {
 public:
  explicit LogReader(const std::string& path);

  std::optional<LogEvent> next();

  std::int64_t events() const { return events_; }
  std::int64_t damages() const { return damages_; }             ///< places that had to be skipped
  std::int64_t skippedBytes() const { return skipped_bytes_; }  ///< in those places
  bool truncated() const { return truncated_; }                 ///< the last event is incomplete
  std::int64_t fileBytes() const { return size_; }

 private:
  struct Header {
    std::int64_t number = 0;
    std::int64_t utime = 0;
    std::int64_t channel_bytes = 0;
    std::int64_t data_bytes = 0;
  };

  std::optional<Header> headerAt(std::int64_t at);
  std::optional<std::int64_t> findHeader(std::int64_t from, std::int64_t to);
  bool read(std::int64_t at, void* out, std::size_t bytes);

  std::ifstream file_;
  std::int64_t size_ = 0;
  std::int64_t at_ = 0;
  std::int64_t events_ = 0;
  std::int64_t damages_ = 0;
  std::int64_t skipped_bytes_ = 0;
  bool truncated_ = false;
};

/// Writes a standard LCM event log, readable by lcm-logplayer. Throws std::runtime_error, naming
/// the file, when it cannot be written.
class LogWriter {
 public:
  /// Replaces the file.
  explicit LogWriter(const std::string& path);

  /// The event's number is set by the writer. Throws std::invalid_argument when channel or data
  /// exceed the bounds above.
  void write(std::int64_t utime, const std::string& channel, const std::vector<std::uint8_t>& data);
  void flush();
  std::int64_t bytes() const { return bytes_; }
  std::int64_t events() const { return events_; }

 private:
  std::string path_;
  std::ofstream file_;
  std::int64_t bytes_ = 0;
  std::int64_t events_ = 0;
};

}  // namespace rf
