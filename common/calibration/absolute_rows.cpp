// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/absolute_rows.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "calibration/row_parts.hpp"

namespace rf::calibration {
namespace {

constexpr std::array<double, 9> kCorrelationTimes = {0.25, 0.5, 1, 2, 4, 8, 16, 32, 64};  ///< s

SE3 errorOf(const Path& path, const PoseRow& row, const CalibrationValues& values) {
  return values.T_AX.inverse() * path.at(row.time - values.time_offset).inverse() * row.T_CX;
}

Eigen::Matrix<double, 6, kParameters> jacobianOf(const Path& path, const PoseRow& row,
                                                 const CalibrationValues& values) {
  const SE3& X = values.T_AX;
  const SE3 E = errorOf(path, row, values);
  const Mat6 Jr = inverseRightJacobian(E.log());
  Eigen::Matrix<double, 6, kParameters> J = Eigen::Matrix<double, 6, kParameters>::Zero();
  // X exp(xi): E -> exp(-xi) E, and xi = R' (delta_t, phi).
  const Mat6 by_xi = -Jr * E.inverse().adjoint();
  J.block<6, 3>(0, kX) = by_xi.leftCols<3>() * X.R().transpose();
  J.block<6, 3>(0, kRoll) = by_xi.rightCols<3>() * X.R().transpose();
  // T_CA(t - offset) -> T_CA exp(-twist d offset).
  J.col(kTime) =
      Jr * (E.inverse() * X.inverse()).adjoint() * path.twistAt(row.time - values.time_offset);
  return J;
}

}  // namespace

AbsoluteRows::AbsoluteRows(std::shared_ptr<const Path> path_A, std::vector<PoseRow> rows,
                           double correlation_time)
    : path_A_(std::move(path_A)), rows_(std::move(rows)), correlation_time_(correlation_time) {}

double AbsoluteRows::memory(std::size_t row) const {
  if (row == 0) return 0;
  return std::exp(-(rows_[row].time - rows_[row - 1].time) / correlation_time_);
}

void AbsoluteRows::evaluate(const CalibrationValues& values, Eigen::VectorXd* r,
                            Eigen::MatrixXd* J) const {
  const auto size = static_cast<Eigen::Index>(6 * rows_.size());
  r->resize(size);
  if (J != nullptr) J->resize(size, kParameters);
  Vec6 e_before = Vec6::Zero();
  Eigen::Matrix<double, 6, kParameters> J_before = Eigen::Matrix<double, 6, kParameters>::Zero();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(6 * i);
    const double a = memory(i);
    const Vec6 e = errorOf(*path_A_, rows_[i], values).log();
    r->segment<6>(at) = e - a * e_before;
    e_before = e;
    if (J == nullptr) continue;
    const Eigen::Matrix<double, 6, kParameters> J_here = jacobianOf(*path_A_, rows_[i], values);
    J->middleRows<6>(at) = J_here - a * J_before;
    J_before = J_here;
  }
}

std::vector<Vec6> AbsoluteRows::poseErrors(const CalibrationValues& values) const {
  std::vector<Vec6> errors;
  for (const PoseRow& row : rows_) errors.push_back(errorOf(*path_A_, row, values).log());
  return errors;
}

std::vector<NoiseComponent> AbsoluteRows::noise(const CalibrationValues& /*values*/) const {
  const auto alone = [&](const Mat6& S) {
    BlockTridiagonal K(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double a = memory(i);
      K.diagonal[i] = (1 + a * a) * S;
      if (i > 0) K.below[i] = -a * S;
    }
    return K;
  };
  const auto lasting = [&](const Mat6& S) {
    BlockTridiagonal K(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double a = memory(i);
      K.diagonal[i] = (1 - a * a) * S;
    }
    return K;
  };
  const Mat6 translation = isotropic(1, 0);
  const Mat6 rotation = isotropic(0, 1);
  return {{"position of each pose, m", 9e-6, 1e-18, alone(translation)},
          {"rotation of each pose, rad", 9e-6, 1e-18, alone(rotation)},
          {"lasting error of position, m", 9e-6, 1e-18, lasting(translation)},
          {"lasting error of rotation, rad", 9e-6, 1e-18, lasting(rotation)}};
}

std::vector<std::unique_ptr<RowModel>> AbsoluteRows::otherForms() const {
  std::vector<std::unique_ptr<RowModel>> out;
  for (const double time : kCorrelationTimes) {
    if (time == correlation_time_) continue;
    out.push_back(std::make_unique<AbsoluteRows>(path_A_, rows_, time));
  }
  return out;
}

std::unique_ptr<RowModel> AbsoluteRows::subset(const std::vector<bool>& keep) const {
  std::vector<PoseRow> kept;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (keep[i]) kept.push_back(rows_[i]);
  }
  return std::make_unique<AbsoluteRows>(path_A_, std::move(kept), correlation_time_);
}

}  // namespace rf::calibration
