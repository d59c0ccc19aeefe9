// SPDX-License-Identifier: BSD-3-Clause
#include "child.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace rf {
namespace {

/// Runs in the child between fork and exec: only calls that are safe there.
[[noreturn]] void become(const std::vector<char*>& argv, const char* log_path, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  setpgid(0, 0);  // Ctrl-C in the terminal reaches the launcher alone, which stops us in order
  const int log = open(log_path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (log >= 0) {
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
  }
  if (getppid() == parent) execv(argv[0], argv.data());
  _exit(127);
}

}  // namespace

Child::Child(std::string name, const std::vector<std::string>& arguments,
             const std::string& log_path)
    : name_(std::move(name)), log_path_(log_path) {
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  if (access(argv[0], X_OK) != 0) throw std::runtime_error(arguments[0] + ": no such program");
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error(name_ + ": cannot be started: " + std::strerror(errno));
  if (pid_ == 0) become(argv, log_path_.c_str(), parent);
}

Child::Child(Child&& other) noexcept
    : name_(std::move(other.name_)),
      log_path_(std::move(other.log_path_)),
      pid_(other.pid_),
      code_(other.code_) {
  other.pid_ = -1;
}

Child::~Child() {
  if (pid_ < 0 || exitCode()) return;
  askToStop();
  waitFor(std::chrono::seconds(5));
}

std::optional<int> Child::exitCode() {
  int status = 0;
  if (!code_ && pid_ > 0 && waitpid(pid_, &status, WNOHANG) == pid_) {
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return code_;
}

void Child::askToStop() {
  if (!exitCode()) kill(pid_, SIGTERM);
}

int Child::waitFor(std::chrono::seconds longest) {
  const auto deadline = std::chrono::steady_clock::now() + longest;
  while (!exitCode()) {
    if (std::chrono::steady_clock::now() > deadline) kill(pid_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return *code_;
}

std::string Child::logTail(std::size_t lines) const {
  std::ifstream file(log_path_);
  std::deque<std::string> tail;
  for (std::string line; std::getline(file, line);) {
    tail.push_back(line);
    if (tail.size() > lines) tail.pop_front();
  }
  std::string out;
  for (const std::string& line : tail) out += "  " + line + "\n";
  return out;
}

}  // namespace rf
