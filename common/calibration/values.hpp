// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/se3.hpp"

namespace rf::calibration {

/// Input that cannot be used: the text names the source, the value and the violated rule.
class CalibrationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< of one radian

/// What a calibration can estimate. A is the body whose poses come with their own clock and scale
/// (the base by its wheels, the gripper by its joints), X the body that is seen (camera, object).
struct CalibrationValues {
  SE3 T_AX;
  double time_offset = 0;        ///< s; added to A's stamps it gives X's clock
  double translation_scale = 1;  ///< true distance over reported distance of A
  double rotation_scale = 1;     ///< true angle over reported angle of A
};

/// Coordinates of a change of the values: translation of X along A's axes (m), rotation of X about
/// A's axes (rad; R <- exp(phi) R), time offset (s), scales (-). Unlike a right perturbation of
/// T_AX it leaves height and horizontal directions of a base unmixed.
inline constexpr int kParameters = 9;
enum ParameterIndex : int { kX, kY, kZ, kRoll, kPitch, kYaw, kTime, kScale, kTurnScale };
using ParameterVector = Eigen::Matrix<double, kParameters, 1>;
using ParameterMatrix = Eigen::Matrix<double, kParameters, kParameters>;
using ParameterMask = std::array<bool, kParameters>;

/// values changed by delta.
CalibrationValues plus(const CalibrationValues& values, const ParameterVector& delta);
/// How a change at the changed values follows delta: plus(values, delta + d) =
/// plus(plus(values, delta), plusJacobian(delta) d) to first order in d.
ParameterMatrix plusJacobian(const ParameterVector& delta);
/// The delta with plus(from, delta) = to.
ParameterVector difference(const CalibrationValues& to, const CalibrationValues& from);
/// d difference(plus(to, delta), from) / d delta at delta = 0.
ParameterMatrix differenceJacobian(const CalibrationValues& to, const CalibrationValues& from);

/// Covariance of the right perturbation T_AX exp(xi), translation first, from that of the
/// parameters: the first six coordinates turned into X's axes, the others as they are.
ParameterMatrix rightPerturbationCovariance(const CalibrationValues& values,
                                            const ParameterMatrix& covariance);

/// Parameters that are asked for together.
enum class ParameterGroup { kTranslation, kRotation, kTime, kScale, kTurnScale };
inline constexpr std::array<ParameterGroup, 5> kGroups = {
    ParameterGroup::kTranslation, ParameterGroup::kRotation, ParameterGroup::kTime,
    ParameterGroup::kScale, ParameterGroup::kTurnScale};
/// The word of the command line: translation, rotation, time, scale, turn-scale.
std::string name(ParameterGroup group);
ParameterMask maskOf(ParameterGroup group);
ParameterMask maskOf(const std::vector<ParameterGroup>& groups);

/// Values known before, and how well; a standard deviation says nothing of parameters that the
/// data determines.
struct CalibrationPrior {
  CalibrationValues values;
  bool has_transform = true;        ///< false: nothing is known of T_AX
  double sigma_translation = 0.05;  ///< m, each axis
  double sigma_rotation = 0.0873;   ///< rad, each axis (5 degrees)
  double sigma_time = 0.1;          ///< s
  double sigma_scale = 0.05;
  double sigma_turn_scale = 0.05;
  ParameterVector sigmas() const;
};

}  // namespace rf::calibration
