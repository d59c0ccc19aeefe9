// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rf {

/// One surfel for export; static body: world frame, object: object frame.
struct SurfelPoint {
  float x = 0, y = 0, z = 0;     ///< metres
  float nx = 0, ny = 0, nz = 0;  ///< unit normal
  std::uint8_t red = 0, green = 0, blue = 0;
  float radius = 0;      ///< metres
  float confidence = 0;  ///< probability that the surface is there, 0..1
  bool operator==(const SurfelPoint&) const = default;
};

}  // namespace rf
