// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/observability.hpp"
#include "calibration/row_model.hpp"

namespace rf::calibration {

/// What was estimated and how well it is known.
struct Estimate {
  CalibrationValues values;
  ParameterMatrix covariance = ParameterMatrix::Zero();   ///< of difference(truth, values)
  ParameterMatrix information = ParameterMatrix::Zero();  ///< of the data alone
  Observability observability;
  std::vector<NoiseComponent> noise;  ///< likeliest; patterns dropped
  std::vector<bool> used;             ///< rows that did not contradict the others
  std::vector<double> surprise;       ///< per row, squared normalised innovation; 6 on average
  double widening = 1;                ///< factor on the variances: errors last longer than modelled
  bool converged = false;
};

/// Maximum likelihood with Ceres: first with a robust loss and nominal noise, then with the noise
/// estimated from the residuals and all rows whitened together, rows far outside left out; last,
/// values and covariance averaged over what the noise may be (NoiseAverage). The prior holds the
/// directions that the data does not observe and acts nowhere else.
/// Of several starts the one that leads to smaller residuals is followed. Inactive parameters keep
/// their start. Deterministic.
Estimate estimate(const RowModel& model, const std::vector<CalibrationValues>& starts,
                  const CalibrationPrior& prior, const ParameterMask& active);

}  // namespace rf::calibration
