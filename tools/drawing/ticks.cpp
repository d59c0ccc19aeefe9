// SPDX-License-Identifier: BSD-3-Clause
#include "ticks.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace rf::render {

double tickStep(double extent, int ticks) {
  const double raw = extent / ticks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) return factor * power;
  }
  return 10 * power;
}

std::string tickLabel(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  return fmt::format("{:.{}f}", std::abs(value) < step / 2 ? 0.0 : value, decimals);
}

}  // namespace rf::render
