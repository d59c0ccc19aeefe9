// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "evaluation/trajectory_error.hpp"
#include "values/pose_covariance.hpp"

namespace rf {

/// Error of a pose and what the estimator said of it.
struct ErrorSample {
  Vec6 error = Vec6::Zero();  ///< log(T_estimate^-1 T_truth), frame B, translation first
  PoseCovariance claim;
};

/// Normalised error squared per degree of freedom, e' P^-1 e / n: 1 on average for an honest
/// covariance, less for a timid one, more for a bold one.
struct Nees {
  double mean = 0;
  double median = 0;
  double share_above_95 = 0;  ///< of the samples, beyond the 95 % bound of chi-squared (ideal 0.05)
};

/// How honest covariance and health of a trajectory are.
struct Consistency {
  std::size_t samples = 0;
  Nees pose;                  ///< 6 degrees of freedom
  Nees translation;           ///< 3, by the translation's own block of P
  Nees rotation;              ///< 3
  std::size_t tracked = 0;    ///< samples whose health says so
  std::size_t misplaced = 0;  ///< of those: off by more than kMisplaced. A failure.
};

/// Farther off than this a pose must not be called tracked, metres.
inline constexpr double kMisplaced = 0.10;

/// Samples of all pairs that have a covariance of the same moment, but the first pair, whose error
/// is zero by the alignment. `world`: estimate's world -> truth's world; `offset`: the estimated
/// body frame -> the true one (identity for the camera), T_truth ~ world T_estimate offset.
std::vector<ErrorSample> errorSamples(const std::vector<PosePair>& pairs,
                                      const PoseCovariances& covariances, const SE3& world,
                                      const SE3& offset);

/// Throws std::invalid_argument when a covariance is not positive definite.
Consistency scoreConsistency(const std::vector<ErrorSample>& samples);

}  // namespace rf
