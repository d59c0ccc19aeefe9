// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/image.hpp"
#include "mapping/fusion_config.hpp"

namespace rf {

/// Alignment that looks for a lost model: farther, but only convinced by more.
FusionConfig wideSearch(FusionConfig config);

/// How much farther than usual.
inline constexpr double kWideShift = 3.0, kWideTurn = 2.0;

/// Factor on a start's covariance in that search.
inline constexpr double kSearchInflation = 10.0;

/// Weight 1 wherever there is depth.
Image<float> everywhere(const Image<float>& depth);

}  // namespace rf
