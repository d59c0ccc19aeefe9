// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace rf {

/// A program that runs beside us, its output in a file. It is stopped with us, even when we are
/// killed.
class Child {
 public:
  /// Starts it. Throws std::runtime_error when it cannot be started.
  Child(std::string name, const std::vector<std::string>& arguments, const std::string& log_path);
  ~Child();
  Child(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child& operator=(Child&&) = delete;

  const std::string& name() const { return name_; }
  pid_t pid() const { return pid_; }
  /// The exit code once it has ended (128 + signal when a signal ended it); does not wait.
  std::optional<int> exitCode();
  /// SIGTERM.
  void askToStop();
  /// Waits; SIGKILL when it takes longer. Returns the exit code.
  int waitFor(std::chrono::seconds longest);
  /// The last lines it wrote.
  std::string logTail(std::size_t lines = 12) const;

 private:
  std::string name_;
  std::string log_path_;
  pid_t pid_ = -1;
  std::optional<int> code_;
};

}  // namespace rf
