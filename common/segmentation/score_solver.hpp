// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "segmentation/adjacency.hpp"

namespace rf {

/// Exact minimiser of the score step (paper Eq. 1 for fixed motions, algorithm B.4):
///   E(gamma) = sum_i Delta_i gamma_i + lambda_r [ sum_{i<j} E_ij (gamma_i - gamma_j)^2
///              + sum_i w_i (gamma_i - target_i)^2 ],   0 <= gamma_i <= 1,
/// with Delta_i = l_i^s - l_i^d. Strictly convex for w_i > 0, so the minimiser is unique;
/// primal-dual active set, falling back to solveBoxPrimal should the sets cycle.
/// Weights below 1e-6 are taken as 1e-6. Throws std::invalid_argument when sizes differ, lambda_r
/// <= 0 or a value is not finite.
std::vector<float> solveScores(const std::vector<double>& delta, const std::vector<float>& target,
                               const std::vector<float>& weight, const Adjacency& adjacency,
                               double lambda_r);

/// Minimiser of 1/2 x'Mx - q'x over 0 <= x <= 1 for a symmetric positive definite M by the
/// classical feasible active set: exact, and since every step lowers the energy it cannot cycle.
/// Slower than the primal-dual sets that solveScores tries first.
Eigen::VectorXd solveBoxPrimal(const Eigen::MatrixXd& M, const Eigen::VectorXd& q);

/// E(gamma) above.
double scoreEnergy(const std::vector<double>& gamma, const std::vector<double>& delta,
                   const std::vector<float>& target, const std::vector<float>& weight,
                   const Adjacency& adjacency, double lambda_r);

}  // namespace rf
