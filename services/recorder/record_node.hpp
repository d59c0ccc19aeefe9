// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "messaging/log_file.hpp"
#include "messaging/service.hpp"

namespace rf {

struct RecordOptions {
  std::string output;           ///< log file; split logs get .01, .02 before the extension
  std::string channels = ".*";  ///< regular expression, whole name
  std::int64_t split_mb = 0;    ///< 0: one file
};

/// Writes what passes on both buses to a standard LCM event log. Gaps in the sequence numbers of
/// our own messages and what the mailboxes dropped are counted.
class RecordNode {
 public:
  RecordNode(Service& service, const RecordOptions& options, bool one_bus);
  /// Writes what arrived. True when there was anything.
  bool step();
  void finish();

 private:
  void write(const RawMessage& message);
  void watchSequence(const RawMessage& message);
  void open();
  std::string fileName() const;

  Service& service_;
  RecordOptions options_;
  Inbox::Box bulk_;
  Inbox::Box state_ = 0;
  bool one_bus_;
  std::unique_ptr<LogWriter> log_;
  int file_index_ = 0;
  std::map<std::string, std::int64_t> last_seq_;
  std::chrono::steady_clock::time_point last_flush_;
};

}  // namespace rf
