// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/values.hpp"

#include <cmath>

#include <Eigen/LU>

namespace rf::calibration {
namespace {

Vec3 rotationLog(const Mat3& R) { return SE3(R, Vec3::Zero()).log().tail<3>(); }

/// log(exp(d) exp(w)) = w + leftJacobianInverse(w) d + O(d^2).
Mat3 leftJacobianInverse(const Vec3& w) {
  const double theta = w.norm();
  const Mat3 W = skew(w);
  const double c = theta < 1e-3 ? 1.0 / 12.0
                                : 1.0 / (theta * theta) -
                                      (1.0 + std::cos(theta)) / (2.0 * theta * std::sin(theta));
  return Mat3::Identity() - 0.5 * W + c * W * W;
}

Vec6 rotationTwist(const Vec3& w) {
  Vec6 xi = Vec6::Zero();
  xi.tail<3>() = w;
  return xi;
}

}  // namespace

CalibrationValues plus(const CalibrationValues& values, const ParameterVector& delta) {
  CalibrationValues out = values;
  out.T_AX.t += delta.segment<3>(kX);
  out.T_AX.q = (SE3::exp(rotationTwist(delta.segment<3>(kRoll))).q * values.T_AX.q).normalized();
  out.time_offset += delta[kTime];
  out.translation_scale += delta[kScale];
  out.rotation_scale += delta[kTurnScale];
  return out;
}

ParameterMatrix plusJacobian(const ParameterVector& delta) {
  ParameterMatrix J = ParameterMatrix::Identity();
  J.block<3, 3>(kRoll, kRoll) = leftJacobianInverse(delta.segment<3>(kRoll)).inverse();
  return J;
}

ParameterVector difference(const CalibrationValues& to, const CalibrationValues& from) {
  ParameterVector delta;
  delta << to.T_AX.t - from.T_AX.t, rotationLog(to.T_AX.R() * from.T_AX.R().transpose()),
      to.time_offset - from.time_offset, to.translation_scale - from.translation_scale,
      to.rotation_scale - from.rotation_scale;
  return delta;
}

ParameterMatrix differenceJacobian(const CalibrationValues& to, const CalibrationValues& from) {
  ParameterMatrix J = ParameterMatrix::Identity();
  J.block<3, 3>(kRoll, kRoll) =
      leftJacobianInverse(rotationLog(to.T_AX.R() * from.T_AX.R().transpose()));
  return J;
}

ParameterMatrix rightPerturbationCovariance(const CalibrationValues& values,
                                            const ParameterMatrix& covariance) {
  ParameterMatrix turn = ParameterMatrix::Identity();
  turn.block<3, 3>(kX, kX) = values.T_AX.R().transpose();
  turn.block<3, 3>(kRoll, kRoll) = values.T_AX.R().transpose();
  return turn * covariance * turn.transpose();
}

std::string name(ParameterGroup group) {
  switch (group) {
    case ParameterGroup::kTranslation:
      return "translation";
    case ParameterGroup::kRotation:
      return "rotation";
    case ParameterGroup::kTime:
      return "time";
    case ParameterGroup::kScale:
      return "scale";
    case ParameterGroup::kTurnScale:
      return "turn-scale";
  }
  return "";
}

ParameterMask maskOf(ParameterGroup group) {
  ParameterMask mask{};
  switch (group) {
    case ParameterGroup::kTranslation:
      mask[kX] = mask[kY] = mask[kZ] = true;
      break;
    case ParameterGroup::kRotation:
      mask[kRoll] = mask[kPitch] = mask[kYaw] = true;
      break;
    case ParameterGroup::kTime:
      mask[kTime] = true;
      break;
    case ParameterGroup::kScale:
      mask[kScale] = true;
      break;
    case ParameterGroup::kTurnScale:
      mask[kTurnScale] = true;
      break;
  }
  return mask;
}

ParameterMask maskOf(const std::vector<ParameterGroup>& groups) {
  ParameterMask mask{};
  for (const ParameterGroup g : groups) {
    const ParameterMask own = maskOf(g);
    for (std::size_t k = 0; k < mask.size(); ++k) mask[k] = mask[k] || own[k];
  }
  return mask;
}

ParameterVector CalibrationPrior::sigmas() const {
  ParameterVector s;
  s << Vec3::Constant(sigma_translation), Vec3::Constant(sigma_rotation), sigma_time, sigma_scale,
      sigma_turn_scale;
  return s;
}

}  // namespace rf::calibration
