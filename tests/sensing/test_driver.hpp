// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dlfcn.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

namespace rf {

/// The test driver in this process, for commands. OpenNI2 loads the same library.
class TestDriver {
 public:
  TestDriver() {
    const std::string file =
        std::string(RF_TEST_OPENNI2) + "/OpenNI2/Drivers/librf_test_driver.so.0";
    void* library = dlopen(file.c_str(), RTLD_NOW);
    if (library == nullptr) throw std::runtime_error(dlerror());
    command_ = reinterpret_cast<Command>(dlsym(library, "rfTestDriverCommand"));
    notes_ = reinterpret_cast<Notes>(dlsym(library, "rfTestDriverNotes"));
    if (command_ == nullptr || notes_ == nullptr) throw std::runtime_error(dlerror());
  }

  void tell(const std::string& text) const {
    const std::string faults = command_(text.c_str());
    if (!faults.empty()) throw std::invalid_argument(faults);
  }
  /// What the device was asked for.
  std::string notes() const { return notes_(); }

 private:
  using Command = const char* (*)(const char*);
  using Notes = const char* (*)();
  Command command_ = nullptr;
  Notes notes_ = nullptr;
};

/// True as soon as `condition` is; false when it does not become so within a minute.
inline bool becomes(const std::function<bool()>& condition) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace rf
