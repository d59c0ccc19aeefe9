// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/relative_rows.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "calibration/row_parts.hpp"

namespace rf::calibration {
namespace {

constexpr double kTurnScaleStep = 1e-5;  ///< of the numeric derivative by the scale of rotation

SE3 motion(const Path& path, double from, double to, double scale) {
  SE3 d = path.at(from).inverse() * path.at(to);
  d.t *= scale;
  return d;
}

Vec6 scaledTwist(Vec6 twist, double scale) {
  twist.head<3>() *= scale;
  return twist;
}

/// One row at given values; `turned`: A's path with a little more rotation, or null.
struct RowAt {
  const Path& path;
  const Path* turned;
  const CalibrationValues& values;

  Vec6 residual(const MotionRow& row) const { return relative(row, dA(path, row)).log(); }

  Eigen::Matrix<double, 6, kParameters> jacobian(const MotionRow& row) const {
    const SE3& X = values.T_AX;
    const SE3 d = dA(path, row);
    const SE3 E = relative(row, d);
    const SE3 A_in_X_inverse = X.inverse() * d * X;  // A^-1 with E = A dX
    const Mat6 Jr = inverseRightJacobian(E.log());
    Eigen::Matrix<double, 6, kParameters> J = Eigen::Matrix<double, 6, kParameters>::Zero();
    // X exp(xi): E -> E exp(Ad(dX^-1) (I - Ad(A^-1)) xi), and xi = R' (delta_t, phi).
    const Mat6 by_xi =
        Jr * row.d_X.inverse().adjoint() * (Mat6::Identity() - A_in_X_inverse.adjoint());
    J.block<6, 3>(0, kX) = by_xi.leftCols<3>() * X.R().transpose();
    J.block<6, 3>(0, kRoll) = by_xi.rightCols<3>() * X.R().transpose();
    // dA exp(zeta): E -> exp(-Ad(X^-1) zeta) E.
    const Mat6 by_zeta = -Jr * (E.inverse() * X.inverse()).adjoint();
    J.col(kTime) = by_zeta * byTime(row, d);
    J.col(kScale).noalias() = by_zeta * byScale(d);
    if (turned != nullptr) {
      J.col(kTurnScale) = by_zeta * (d.inverse() * dA(*turned, row)).log() / kTurnScaleStep;
    }
    return J;
  }

 private:
  SE3 dA(const Path& p, const MotionRow& row) const {
    return motion(p, row.from - values.time_offset, row.to - values.time_offset,
                  values.translation_scale);
  }
  SE3 relative(const MotionRow& row, const SE3& d) const {
    return values.T_AX.inverse() * d.inverse() * values.T_AX * row.d_X;
  }
  Vec6 byTime(const MotionRow& row, const SE3& d) const {
    const double s = values.translation_scale;
    const Vec6 at_from = scaledTwist(path.twistAt(row.from - values.time_offset), s);
    const Vec6 at_to = scaledTwist(path.twistAt(row.to - values.time_offset), s);
    return d.inverse().adjoint() * at_from - at_to;
  }
  Vec6 byScale(const SE3& d) const {
    Vec6 zeta = Vec6::Zero();
    zeta.head<3>() = d.q.conjugate() * d.t / values.translation_scale;
    return zeta;
  }
};

/// Noise of each pose alone: `before(i)` carries the error of row i's first pose to its end.
template <class Before>
BlockTridiagonal posePattern(const std::vector<MotionRow>& rows, const Mat6& S,
                             const Before& before) {
  BlockTridiagonal K(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Mat6 Ad = before(rows[i]);
    K.diagonal[i] = S + Ad * S * Ad.transpose();
    if (i > 0 && std::abs(rows[i].from - rows[i - 1].to) < kSameTime) K.below[i] = -Ad * S;
  }
  return K;
}

/// Noise that adds up along the way, independent from row to row.
template <class Block>
BlockTridiagonal walkPattern(const std::vector<MotionRow>& rows, const Block& block) {
  BlockTridiagonal K(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) K.diagonal[i] = block(rows[i]);
  return K;
}

double square(double x) { return x * x; }

}  // namespace

RelativeRows::RelativeRows(std::shared_ptr<const Path> path_A, std::vector<MotionRow> rows,
                           BodyKind kind, bool turn_scale)
    : path_A_(std::move(path_A)), rows_(std::move(rows)), kind_(kind), turn_scale_(turn_scale) {}

void RelativeRows::evaluate(const CalibrationValues& values, Eigen::VectorXd* r,
                            Eigen::MatrixXd* J) const {
  std::optional<Path> scaled;
  std::optional<Path> turned;
  if (turn_scale_) {
    scaled = path_A_->scaled(1, values.rotation_scale);
    if (J != nullptr) turned = path_A_->scaled(1, values.rotation_scale + kTurnScaleStep);
  }
  const RowAt at{scaled ? *scaled : *path_A_, turned ? &*turned : nullptr, values};
  const auto size = static_cast<Eigen::Index>(6 * rows_.size());
  r->resize(size);
  if (J != nullptr) J->resize(size, kParameters);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    r->segment<6>(static_cast<Eigen::Index>(6 * i)) = at.residual(rows_[i]);
    if (J != nullptr) J->middleRows<6>(static_cast<Eigen::Index>(6 * i)) = at.jacobian(rows_[i]);
  }
}

std::vector<Vec6> RelativeRows::poseErrors(const CalibrationValues& values) const {
  Eigen::VectorXd r;
  evaluate(values, &r, nullptr);
  std::vector<Vec6> errors;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    errors.emplace_back(r.segment<6>(static_cast<Eigen::Index>(6 * i)));
  }
  return errors;
}

std::vector<NoiseComponent> RelativeRows::noise(const CalibrationValues& values) const {
  const auto by_X = [](const MotionRow& row) { return row.d_X.inverse().adjoint(); };
  const auto dA = [&](const MotionRow& row) {
    return motion(*path_A_, row.from - values.time_offset, row.to - values.time_offset,
                  values.translation_scale);
  };
  const Mat6 into_X = values.T_AX.inverse().adjoint();
  std::vector<NoiseComponent> out;
  const auto add = [&](const char* what, double sigma, BlockTridiagonal pattern) {
    out.push_back({what, square(sigma), 1e-18, std::move(pattern)});
  };
  add("seen position, m", 0.002, posePattern(rows_, isotropic(1, 0), by_X));
  add("seen rotation, rad", 0.001, posePattern(rows_, isotropic(0, 1), by_X));
  add("drift of position, m/sqrt(s)", 0.005,
      walkPattern(rows_, [](const MotionRow& row) { return isotropic(row.to - row.from, 0); }));
  add("drift of rotation, rad/sqrt(s)", 0.002,
      walkPattern(rows_, [](const MotionRow& row) { return isotropic(0, row.to - row.from); }));
  if (kind_ == BodyKind::kArm) {
    const Mat6 S = into_X * isotropic(0, 1) * into_X.transpose();
    add("rotation of the arm, rad", 0.001, posePattern(rows_, S, by_X));
    return out;
  }
  Vec6 turn = Vec6::Zero();
  turn[5] = 1;
  const Vec6 heading = into_X * turn;
  add("slip of distance, m/sqrt(m)", 0.005,
      walkPattern(rows_, [&](const MotionRow& row) { return isotropic(dA(row).t.norm(), 0); }));
  add("slip of heading, rad/sqrt(rad)", 0.005, walkPattern(rows_, [&](const MotionRow& row) {
        return Mat6(dA(row).log().tail<3>().norm() * heading * heading.transpose());
      }));
  add("slip of heading, rad/sqrt(m)", 0.005, walkPattern(rows_, [&](const MotionRow& row) {
        return Mat6(dA(row).t.norm() * heading * heading.transpose());
      }));
  return out;
}

std::unique_ptr<RowModel> RelativeRows::subset(const std::vector<bool>& keep) const {
  std::vector<MotionRow> kept;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (keep[i]) kept.push_back(rows_[i]);
  }
  return std::make_unique<RelativeRows>(path_A_, std::move(kept), kind_, turn_scale_);
}

}  // namespace rf::calibration
