// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/calibrate.hpp"

namespace rf::calibration {

/// A translation between two bodies that move relative to worlds of their own is not asked of less
/// turning than this, whatever the information matrix says: it would be made of noise.
inline constexpr double kLeastTurn = 0.5236;  ///< rad, 30 degrees

/// Nor a time offset of speeds that vary less.
inline constexpr double kLeastSpeedVariation = 0.03;  ///< m/s, standard deviation
inline constexpr double kLeastTurnVariation = 0.03;   ///< rad/s

/// Why the motion does not give what is asked for, naming what is missing; empty when it does.
std::string refusalOf(const CalibrationRequest& request, const Estimate& estimate,
                      const MotionSummary& motion, const ErrorSize& left);

/// A direction in words: its parameters with the largest part first.
std::string directionName(Problem problem, const Direction& direction);

}  // namespace rf::calibration
