// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "calibration/noise_components.hpp"
#include "calibration/values.hpp"

namespace rf::calibration {

/// What a calibration is fitted to: rows of six residuals (translation first) over time, each with
/// its derivative, and what is known of the form of their noise. Immutable.
class RowModel {
 public:
  RowModel() = default;
  RowModel(const RowModel&) = default;
  RowModel& operator=(const RowModel&) = default;
  virtual ~RowModel() = default;

  virtual std::size_t rows() const = 0;
  /// Middle of the row's time, seconds since the origin of the paths.
  virtual double time(std::size_t row) const = 0;
  /// Residuals (6 * rows) and, unless null, their derivative by the change of plus(values, .).
  virtual void evaluate(const CalibrationValues& values, Eigen::VectorXd* r,
                        Eigen::MatrixXd* J) const = 0;
  /// Causes of noise with a plausible variance to start from.
  virtual std::vector<NoiseComponent> noise(const CalibrationValues& values) const = 0;
  /// The same rows under other forms of noise that are as likely beforehand; none: the form is
  /// known. Each combines the rows in its own way, with determinant one, so that likelihoods
  /// compare.
  virtual std::vector<std::unique_ptr<RowModel>> otherForms() const { return {}; }
  /// The same rows without those that are not kept.
  virtual std::unique_ptr<RowModel> subset(const std::vector<bool>& keep) const = 0;
  /// Error of each row as a pose error (m, rad), without any differencing in time.
  virtual std::vector<Vec6> poseErrors(const CalibrationValues& values) const = 0;
};

}  // namespace rf::calibration
