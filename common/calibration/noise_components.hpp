// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/block_tridiagonal.hpp"

namespace rf::calibration {

/// One cause of error: the covariance of all rows is the sum of variance * pattern over the causes.
struct NoiseComponent {
  std::string name;      ///< in words, with the unit of its standard deviation
  double variance = 0;   ///< start value in, estimate out
  double floor = 1e-18;  ///< never below
  BlockTridiagonal pattern;
};

BlockTridiagonal covarianceOf(const std::vector<NoiseComponent>& components);

/// Variances from the residuals r (6 * rows) of a least-squares fit with Jacobian J, by restricted
/// maximum likelihood: what the fitted parameters have taken out of the residuals is counted. The
/// multiplicative updates keep every variance positive and never lower the likelihood (Zhou, Hu,
/// Zhou, Lange: MM Algorithms for Variance Components Models, 2019).
/// J may have zero columns.
void estimateVariances(const Eigen::VectorXd& r, const Eigen::MatrixXd& J, int iterations,
                       std::vector<NoiseComponent>* components);

/// Twice the logarithm of the restricted likelihood, up to a constant.
double restrictedLikelihood(const Eigen::VectorXd& r, const Eigen::MatrixXd& J,
                            const std::vector<NoiseComponent>& components);

}  // namespace rf::calibration
