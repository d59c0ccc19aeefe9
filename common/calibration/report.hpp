// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/calibrate.hpp"

namespace rf::calibration {

/// What was found, how well and by what, in plain words (Markdown). For a refusal: what is missing.
std::string toMarkdown(const CalibrationResult& result);

/// One row and column per parameter: the covariance of the right perturbation of T_AX, translation
/// first, in X's axes, then time offset and scales; m, rad, s. What was not asked for has zeros.
std::string covarianceCsv(const CalibrationResult& result);

/// One row per interval or pose: time, part (fit, left_out, held_out), error in X's axes (m, rad)
/// and the squared normalised innovation.
std::string residualsCsv(const CalibrationResult& result);

/// The values as YAML; for odometry a configuration that rf-run, rf-prior and rf-launch read.
std::string toYaml(const CalibrationResult& result);

}  // namespace rf::calibration
