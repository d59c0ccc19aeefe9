// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/values.hpp"

namespace rf::calibration {

/// A direction in which the data says something or nothing: an eigenvector of the data's
/// information matrix with every parameter counted in its prior's standard deviations.
struct Direction {
  ParameterVector vector = ParameterVector::Zero();  ///< unit, in prior standard deviations
  double gain = 0;                                   ///< prior sigma over the data's sigma along it
  bool observed = false;
};

/// What the data says of the parameters.
struct Observability {
  std::vector<Direction> directions;                ///< of the active parameters, weakest first
  ParameterVector share = ParameterVector::Zero();  ///< of each parameter's axis that is observed
  /// Precision of the prior in what is not observed. What is does not mix with it: the directions
  /// are eigenvectors.
  ParameterMatrix prior_information = ParameterMatrix::Zero();
};

/// A direction counts as observed when the data alone knows it at least this much better than the
/// prior: then the prior is not used for it; else it stays at the prior.
inline constexpr double kObservedGain = 3.0;

Observability observe(const ParameterMatrix& information, const ParameterVector& prior_sigmas,
                      const ParameterMask& active);

/// Whether the data observes any direction of the group when all else is known no better than the
/// prior says.
bool observesAny(const ParameterMatrix& information, const ParameterVector& prior_sigmas,
                 const ParameterMask& active, ParameterGroup group);

}  // namespace rf::calibration
