// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace rf {

/// The level of whitened residuals that frames usually leave, and whether one stands out: then the
/// motion that was found does not explain the picture (a wrong minimum, a leap of the camera).
/// On 78 runs where that did not happen, real ones and twice the noise among them, no frame left
/// more than 2.3 times the usual; where it did, 4 to 87 times (docs/HEALTH.md).
class UsualResidual {
 public:
  bool exceededBy(double rms_sigma) const { return rms_sigma > kFactor * mean_; }

  /// A level that stays becomes the usual one within a second.
  void learn(double rms_sigma) {
    mean_ += kMemory * (std::min(rms_sigma, kMostGrowth * mean_) - mean_);
    mean_ = std::max(mean_, kLeast);
  }

 private:
  static constexpr double kFactor = 3.0;
  static constexpr double kMemory = 0.1;      // ten frames
  static constexpr double kMostGrowth = 2.0;  // what one frame can say of the level
  static constexpr double kLeast = 0.1;       // of a perfect sensor: still a level
  double mean_ = 1.0;                         // as the sensor model says
};

}  // namespace rf
