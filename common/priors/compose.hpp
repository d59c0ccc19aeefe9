// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "values/motion_prior.hpp"

namespace rf {

/// The prior of A -> C from those of A -> B and B -> C: increments are multiplied, covariances
/// added in the frame of C to first order, as independent. A body that is missing in either is
/// missing in the result, one that is extrapolated in either is extrapolated; object priors of
/// different kinds do not compose (missing). The robot's own shapes are those at C. Throws
/// std::invalid_argument when the pairs do not meet at B.
MotionPrior composePriors(const MotionPrior& ab, const MotionPrior& bc);

}  // namespace rf
