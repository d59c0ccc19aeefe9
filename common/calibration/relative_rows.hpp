// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "calibration/path.hpp"
#include "calibration/row_model.hpp"

namespace rf::calibration {

/// A motion of X between two of its poses.
struct MotionRow {
  double from = 0, to = 0;  ///< s, X's clock
  SE3 d_X;                  ///< T_VX(from)^-1 T_VX(to), V any world
};

/// What moves A, and so how its poses err.
enum class BodyKind {
  kWheels,  ///< distance and heading (about A's z) slip with the way
  kArm,     ///< each pose errs alone
};

/// AX = XB: over the same time A and X, rigidly connected, make the same motion in their own
/// frames. With dA(offset, scales) from A's path at X's times minus the offset,
///   r = log( (T_AX^-1 dA T_AX)^-1 dX ).
/// Rows that share a pose of X are coupled by that pose's noise.
class RelativeRows : public RowModel {
 public:
  /// `rows` in increasing time. `turn_scale`: derivatives by the scale of rotation too.
  RelativeRows(std::shared_ptr<const Path> path_A, std::vector<MotionRow> rows, BodyKind kind,
               bool turn_scale);

  std::size_t rows() const override { return rows_.size(); }
  double time(std::size_t row) const override { return 0.5 * (rows_[row].from + rows_[row].to); }
  void evaluate(const CalibrationValues& values, Eigen::VectorXd* r,
                Eigen::MatrixXd* J) const override;
  std::vector<NoiseComponent> noise(const CalibrationValues& values) const override;
  std::unique_ptr<RowModel> subset(const std::vector<bool>& keep) const override;
  std::vector<Vec6> poseErrors(const CalibrationValues& values) const override;

 private:
  std::shared_ptr<const Path> path_A_;
  std::vector<MotionRow> rows_;
  BodyKind kind_;
  bool turn_scale_;
};

}  // namespace rf::calibration
