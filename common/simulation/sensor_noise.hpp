// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "geometry/image.hpp"

namespace rf::sim {

/// Normal numbers of zero mean and unit variance that are alike within a square of 2 radius + 1
/// pixels. The key (seed, frame, purpose) alone decides the values, for any number of threads.
Image<float> correlatedNoise(int width, int height, int radius, std::uint64_t key);

}  // namespace rf::sim
