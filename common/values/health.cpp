// SPDX-License-Identifier: BSD-3-Clause
#include "values/health.hpp"

namespace rf {

std::string_view name(Health health) {
  switch (health) {
    case Health::kTracked:
      return "tracked";
    case Health::kDegraded:
      return "degraded";
    case Health::kPriorOnly:
      return "prior-only";
    case Health::kLost:
      return "lost";
    case Health::kInvalid:
      break;
  }
  return "invalid";
}

std::optional<Health> healthFromWire(std::int8_t value) {
  if (value < 1 || value > 4) return std::nullopt;
  return static_cast<Health>(value);
}

}  // namespace rf
