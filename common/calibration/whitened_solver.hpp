// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration/row_model.hpp"

namespace rf::calibration {

/// Least squares on rows whitened one by one under a Cauchy loss, with the prior on every active
/// parameter: finds the values among rows that lie far outside. `row_noise` must not couple rows.
CalibrationValues solveRobust(const RowModel& model, const BlockFactor& row_noise,
                              const CalibrationValues& start, const CalibrationPrior& prior,
                              const ParameterMatrix& prior_information,
                              const ParameterMask& active);

/// Least squares on all rows whitened together, with the prior of the given precision.
CalibrationValues solveWhitened(const RowModel& model, const BlockFactor& noise,
                                const CalibrationValues& start, const CalibrationPrior& prior,
                                const ParameterMatrix& prior_information,
                                const ParameterMask& active, bool* converged);

}  // namespace rf::calibration
