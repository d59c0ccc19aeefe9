// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/check.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rf {
namespace {

constexpr double kQuaternionTolerance = 1e-6;
constexpr std::size_t kMaxText = 4096;
constexpr std::size_t kMaxStages = 64;

}  // namespace

void Check::rule(bool holds, const std::string& problem) {
  if (!holds && problem_.empty()) problem_ = what_ + ": " + problem;
}

void Check::finite(const char* member, double value) {
  if (!std::isfinite(value)) rule(false, fmt::format("{} is {}, must be finite", member, value));
}

void Check::nonNegative(const char* member, double value) {
  if (!(std::isfinite(value) && value >= 0)) {
    rule(false, fmt::format("{} is {}, must be finite and not negative", member, value));
  }
}

void Check::range(const char* member, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    rule(false, fmt::format("{} is {}, must be within {} to {}", member, value, low, high));
  }
}

void Check::transform(const char* member, const SE3& T) {
  if (!T.isFinite()) {
    rule(false, fmt::format("{} is not finite: translation {} {} {}, quaternion wxyz {} {} {} {}",
                            member, T.t.x(), T.t.y(), T.t.z(), T.q.w(), T.q.x(), T.q.y(), T.q.z()));
  } else if (std::abs(T.q.norm() - 1) > kQuaternionTolerance) {
    rule(false, fmt::format("{}'s quaternion has length {}, must be 1", member, T.q.norm()));
  }
}

void Check::covariance(const char* member, const Mat6& covariance) {
  if (!covariance.allFinite()) {
    rule(false, fmt::format("{} is not finite", member));
  } else if (covariance.diagonal().minCoeff() < 0) {
    rule(false, fmt::format("{} has the variance {}, must not be negative", member,
                            covariance.diagonal().minCoeff()));
  }
}

void Check::health(const char* member, Health health, bool may_be_invalid) {
  const int value = static_cast<int>(health);
  if (value < (may_be_invalid ? 0 : 1) || value > 4) {
    rule(false,
         fmt::format("{} is {}, must be within {} to 4", member, value, may_be_invalid ? 0 : 1));
  }
}

void Check::stageTimes(const StageTimes& times) {
  if (times.size() > kMaxStages) {
    rule(false, fmt::format("{} stages, at most {} are allowed", times.size(), kMaxStages));
  }
  for (const auto& [name, ms] : times) {
    text("stage_name", name);
    nonNegative("stage_ms", ms);
  }
}

void Check::text(const char* member, const std::string& value) {
  if (value.size() > kMaxText) {
    rule(false,
         fmt::format("{} has {} bytes, at most {} are allowed", member, value.size(), kMaxText));
  } else if (value.find('\0') != std::string::npos) {
    rule(false, fmt::format("{} holds a zero byte", member));
  }
}

}  // namespace rf
