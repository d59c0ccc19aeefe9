// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration/path.hpp"

namespace rf::calibration {

/// How much there was to see of a motion.
struct MotionSummary {
  double duration = 0;              ///< s
  double travelled = 0;             ///< m, sum over motions of a second
  double turned = 0;                ///< rad, likewise
  Vec3 axis_shares = Vec3::Zero();  ///< of the squared turning, strongest axis first; sums to 1
  double speed_variation = 0;       ///< m/s, standard deviation of the speed
  double turn_variation = 0;        ///< rad/s, of the speed of turning
};

/// Between two times of the path.
MotionSummary summarise(const Path& path, double from, double to);

}  // namespace rf::calibration
