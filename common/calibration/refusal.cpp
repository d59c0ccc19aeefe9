// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/refusal.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace rf::calibration {
namespace {

constexpr double kPartInName = 0.1;  ///< of the square, to be named

std::string reasonOf(const CalibrationRequest& request, ParameterGroup group,
                     const MotionSummary& m, const ErrorSize& left) {
  const std::string A = nameOfA(request.problem);
  const std::string X = nameOfX(request.problem);
  if (request.same_frame && group != ParameterGroup::kTime) {
    return fmt::format(
        "{} of the {}: every pose shows it, but after the fit {:.0f} mm and {:.1f} degrees are "
        "left "
        "of them: was the {} tracked, and held by the {}?",
        name(group), X, 1e3 * left.translation, left.rotation * kDegrees, X, A);
  }
  switch (group) {
    case ParameterGroup::kTranslation:
      if (m.turned < kLeastTurn) {
        return fmt::format(
            "translation of the {}: the {} turned by {:.0f} degrees in all; at least {:.0f} are "
            "needed",
            X, A, m.turned * kDegrees, kLeastTurn * kDegrees);
      }
      return fmt::format(
          "translation of the {}: the {} turned by {:.0f} degrees in all, which against the "
          "noise fixes no direction of it: turn more",
          X, A, m.turned * kDegrees);
    case ParameterGroup::kRotation:
      return fmt::format(
          "rotation of the {}: the {} turned by {:.0f} degrees and travelled {:.2f} m in all; turn "
          "by at least 30 degrees or travel at least 1 m",
          X, A, m.turned * kDegrees, m.travelled);
    case ParameterGroup::kTime:
      return fmt::format(
          "time offset: the speed of the {} varies by {:.3f} m/s and {:.1f} degrees/s only; "
          "start, stop and turn, so that a shift in time can be seen",
          A, m.speed_variation, m.turn_variation * kDegrees);
    case ParameterGroup::kScale:
      return fmt::format(
          "scale: the {} travelled {:.2f} m in all; travel at least 2 m, straight for a part", A,
          m.travelled);
    case ParameterGroup::kTurnScale:
      return fmt::format("scale of turning: the {} turned by {:.0f} degrees in all; turn by more",
                         A, m.turned * kDegrees);
  }
  return {};
}

/// How the turning was distributed, where that is the reason.
std::string axesHint(const MotionSummary& m) {
  if (m.turned < kLeastTurn || m.axis_shares[1] > 0.02) return {};
  return fmt::format(
      " ({:.1f} % of the turning is about one axis; turn about a second one to fix it, or give a "
      "prior)",
      100 * m.axis_shares[0]);
}

std::string withoutPrior(const CalibrationRequest& request, const Estimate& e,
                         const MotionSummary& m) {
  for (const Direction& d : e.observability.directions) {
    if (d.observed || d.vector.head<6>().squaredNorm() < 0.05) continue;
    return fmt::format("{}: the motion does not show it and no prior is given{}",
                       directionName(request.problem, d), axesHint(m));
  }
  return {};
}

/// Motion so small that an information matrix of it is made of noise.
bool tooLittle(const CalibrationRequest& request, ParameterGroup group, const MotionSummary& m) {
  if (group == ParameterGroup::kTranslation) return !request.same_frame && m.turned < kLeastTurn;
  if (group == ParameterGroup::kTime) {
    return m.speed_variation < kLeastSpeedVariation && m.turn_variation < kLeastTurnVariation;
  }
  return false;
}

}  // namespace

std::string directionName(Problem problem, const Direction& direction) {
  std::vector<std::pair<double, int>> parts;
  for (int k = 0; k < kParameters; ++k) {
    const double part = direction.vector[k] * direction.vector[k];
    if (part >= kPartInName) parts.emplace_back(-part, k);
  }
  std::sort(parts.begin(), parts.end());
  std::string text;
  for (const auto& [part, k] : parts) {
    text += (text.empty() ? "" : " with ") + parameterName(problem, k);
  }
  return text;
}

std::string refusalOf(const CalibrationRequest& request, const Estimate& estimate,
                      const MotionSummary& motion, const ErrorSize& left) {
  const ParameterMask active = maskOf(request.asked);
  const ParameterMatrix information = estimate.information / estimate.widening;
  std::string text;
  for (const ParameterGroup g : request.asked) {
    if (!tooLittle(request, g, motion) &&
        observesAny(information, request.prior.sigmas(), active, g)) {
      continue;
    }
    text += (text.empty() ? "" : "; ") + reasonOf(request, g, motion, left);
  }
  if (text.empty() && !request.prior.has_transform) text = withoutPrior(request, estimate, motion);
  return text;
}

}  // namespace rf::calibration
