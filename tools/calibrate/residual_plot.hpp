// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "calibration/calibrate.hpp"

namespace rf {

/// Errors of position and rotation over time, one colour an axis; times that were held out are
/// shaded, rows that were left out are grey.
cv::Mat residualPlot(const calibration::CalibrationResult& result);

}  // namespace rf
