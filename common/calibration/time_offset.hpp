// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration/path.hpp"

namespace rf::calibration {

/// Where two recordings of one motion fit best in time.
struct OffsetGuess {
  double offset = 0;       ///< s, added to A's times
  double correlation = 0;  ///< of the better of the two speeds, -1..1; 0 when nothing varies
};

/// Shifts A against X by up to `largest` seconds and compares how fast both turn (the same for all
/// points of a rigid body) and how fast both move; the speed that fits better decides. A start for
/// the estimate, good to some hundredths of a second.
OffsetGuess guessOffset(const Path& A, const Path& X, double largest);

}  // namespace rf::calibration
