// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rf::render {

/// 1, 2 or 5 times a power of ten, so that at most `ticks` of them span `extent` (> 0).
double tickStep(double extent, int ticks);

/// A value on a grid of `step`, with as many decimals as the step needs.
std::string tickLabel(double value, double step);

}  // namespace rf::render
