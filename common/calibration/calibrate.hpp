// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/estimator.hpp"
#include "calibration/motion_rows.hpp"
#include "calibration/motion_summary.hpp"
#include "calibration/time_offset.hpp"

namespace rf::calibration {

/// What is calibrated: A carries its own clock, X is seen.
enum class Problem : std::uint8_t {
  kOdometry,  ///< A = base by its wheels, X = camera: T_BC, time offset, scales
  kGrasp,     ///< A = gripper, X = object: T_GO, time offset
  kHandEye,   ///< A = gripper or flange in the arm's base, X = camera: T_GC, time offset
};

struct CalibrationRequest {
  Problem problem = Problem::kOdometry;
  std::vector<ParameterGroup> asked;  ///< the others keep the prior's values
  CalibrationPrior prior;
  /// Poses of A and X are given in one frame and not in worlds of their own (kGrasp only).
  bool same_frame = false;
  double largest_offset = 0.3;  ///< s
  RowOptions rows;
};

/// Root mean square of errors of motions or poses.
struct ErrorSize {
  std::size_t count = 0;
  double translation = 0;  ///< m
  double rotation = 0;     ///< rad
};

/// One row as the check leaves it.
struct ResidualRow {
  double time = 0;  ///< s of X's clock since the origin
  bool held_out = false;
  bool used = false;          ///< in the fit
  Vec6 error = Vec6::Zero();  ///< pose or motion error, X's axes
  double surprise = 0;        ///< squared normalised innovation where used; 6 on average
};

struct CalibrationResult {
  Problem problem = Problem::kOdometry;
  /// Why there is no calibration: which motion is missing. Empty when there is one.
  std::string refusal;
  std::vector<ParameterGroup> asked;
  CalibrationPrior prior;
  Estimate estimate;     ///< from all rows
  Estimate check;        ///< from those that were not held out; what the errors below are of
  MotionSummary motion;  ///< of A
  OffsetGuess guess;
  DroppedRows dropped;
  std::int64_t origin = 0;  ///< utime of time 0
  double baseline = 0;      ///< s of the motions that the errors below are of; 0: poses
  ErrorSize before, after;  ///< of the held-out part: at the prior, at the estimate
  ErrorSize fit_before, fit_after;
  std::vector<ResidualRow> residuals;
  std::vector<std::string> notes;
};

/// What A and X are in the words of a report.
std::string nameOfA(Problem problem);
std::string nameOfX(Problem problem);
/// "x of the camera" and so on.
std::string parameterName(Problem problem, int parameter);

/// Calibrates from the poses of A and of X. Throws CalibrationError when they cannot be used: bad
/// values or times, no common time, too short, frozen, or motions that have nothing in common.
/// Motion that does not show what is asked for is a refusal in the result. Deterministic.
CalibrationResult calibrate(const CalibrationRequest& request, const Trajectory& A,
                            const Trajectory& X);

}  // namespace rf::calibration
