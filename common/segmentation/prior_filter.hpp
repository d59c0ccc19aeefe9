// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "geometry/se3.hpp"

namespace rf {

/// Spread of an increment's velocity when there is no measurement of it: what a hand, an arm or a
/// wheeled base can change from one frame to the next at 30 Hz (about 3.6 m/s^2 and 9 rad/s^2).
struct VelocitySpread {
  double translation_m = 0.004;
  double rotation_rad = 0.010;
};

/// One accepted increment, prev <- this (right-hand frame = the moving frame at this time).
struct Increment {
  SE3 T;
  Mat6 covariance = Mat6::Identity();
  bool measured =
      false;  ///< false: the prior was missing or rejected; T is the last known velocity
  bool rejected = false;
};

/// Prior plausibility (docs/ALGORITHM.md): an increment that is further than 6.4 sigma + 3 mm (+ 3
/// mrad) from BOTH the last accepted increment AND the last estimate is not believed and replaced
/// by the last estimate, never dropped.
class PriorFilter {
 public:
  explicit PriorFilter(const VelocitySpread& spread) : spread_(spread) {}

  /// `prior` empty = missing. `last_estimate` empty at the start of a stream.
  Increment accept(const std::optional<SE3>& prior, const Mat6& covariance,
                   const std::optional<SE3>& last_estimate);
  void reset() { last_accepted_.reset(); }

 private:
  VelocitySpread spread_;
  std::optional<SE3> last_accepted_;
};

/// Diagonal covariance from a spread.
Mat6 covarianceOf(const VelocitySpread& spread);

/// Product of two consecutive increments A <- B <- C. Translation errors are correlated from frame
/// to frame (drift) and add linearly, rotation errors are nearly white and add in square.
Increment compose(const Increment& ab, const Increment& bc);

}  // namespace rf
