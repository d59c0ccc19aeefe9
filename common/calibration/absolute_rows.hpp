// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "calibration/path.hpp"
#include "calibration/row_model.hpp"

namespace rf::calibration {

/// A pose of X in the frame that A's poses are given in as well.
struct PoseRow {
  double time = 0;  ///< s, X's clock
  SE3 T_CX;
};

/// A and X, rigidly connected, seen in one frame C: T_CX(t) = T_CA(t - offset) T_AX, error
///   e(t) = log( T_AX^-1 T_CA(t - offset)^-1 T_CX(t) ).
/// Errors of a tracked pose last: they are taken as a part that is forgotten over
/// `correlation_time` (s) and a part of each pose alone. Rows are the errors with what the row
/// before predicts of them taken off, r(k) = e(k) - exp(-dt / correlation_time) e(k-1), so that
/// only neighbours are coupled. Other correlation times are the other forms of the noise.
class AbsoluteRows : public RowModel {
 public:
  AbsoluteRows(std::shared_ptr<const Path> path_A, std::vector<PoseRow> rows,
               double correlation_time = 2);

  std::size_t rows() const override { return rows_.size(); }
  double time(std::size_t row) const override { return rows_[row].time; }
  void evaluate(const CalibrationValues& values, Eigen::VectorXd* r,
                Eigen::MatrixXd* J) const override;
  std::vector<NoiseComponent> noise(const CalibrationValues& values) const override;
  /// With correlation times of equal ratio: their prior is uniform in the logarithm.
  std::vector<std::unique_ptr<RowModel>> otherForms() const override;
  std::unique_ptr<RowModel> subset(const std::vector<bool>& keep) const override;
  std::vector<Vec6> poseErrors(const CalibrationValues& values) const override;

 private:
  /// Share of the error of row - 1 that is left at row; 0 for the first.
  double memory(std::size_t row) const;

  std::shared_ptr<const Path> path_A_;
  std::vector<PoseRow> rows_;
  double correlation_time_;
};

}  // namespace rf::calibration
