// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/fusion_config.hpp"

namespace rf {

/// Depth noise as plain floats for inner loops.
struct SensorModel {
  float base = 0.0012F, growth = 0.0019F, near = 0.4F;

  explicit SensorModel(const SensorConfig& c)
      : base(static_cast<float>(c.noise * c.sigma_base_m)),
        growth(static_cast<float>(c.noise * c.sigma_growth)),
        near(static_cast<float>(c.sigma_near_m)) {}

  /// Standard deviation (m) of a depth of z metres.
  float sigma(float z) const {
    const float d = z > near ? z - near : 0.0F;
    return base + growth * d * d;
  }
};

}  // namespace rf
