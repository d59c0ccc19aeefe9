// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "values/segmentation_result.hpp"

namespace rf {

/// Writes down how long each step took; a step begins where the one before ended.
class StageClock {
 public:
  void lap(const char* stage, StageTimes& out) {
    const auto now = std::chrono::steady_clock::now();
    out.emplace_back(stage, std::chrono::duration<double, std::milli>(now - last_).count());
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace rf
