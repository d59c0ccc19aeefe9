// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace rf {

/// What a pose estimate is worth. The numbers are those on the wire.
enum class Health : std::int8_t {
  kInvalid = 0,    ///< never set by a stage; a message without it is malformed
  kTracked = 1,    ///< image (and prior, where there is one) agree
  kDegraded = 2,   ///< estimated from the image with weak support, or without the expected prior
  kPriorOnly = 3,  ///< image carried no usable information: the prior (or constant velocity) alone
  kLost = 4,       ///< neither: the pose is the last known one and must not be trusted
};

/// Lower-case name as written in frames.csv: "tracked", "degraded", "prior-only", "lost",
/// "invalid".
std::string_view name(Health health);
std::optional<Health> healthFromWire(std::int8_t value);

}  // namespace rf
