// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/noise_components.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace rf::calibration {
namespace {

constexpr double kRankTolerance = 1e-12;

/// Pseudo-inverse and log of the product of positive eigenvalues of a positive semi-definite
/// matrix, scaled to unit diagonal before the rank is judged.
struct Pseudo {
  Eigen::MatrixXd inverse;
  double log_determinant = 0;
};

Pseudo pseudoInverse(const Eigen::MatrixXd& H) {
  Pseudo out{Eigen::MatrixXd::Zero(H.rows(), H.cols()), 0};
  const Eigen::VectorXd scale =
      H.diagonal().unaryExpr([](double d) { return d > 0 ? 1.0 / std::sqrt(d) : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H *
                                                             scale.asDiagonal());
  for (Eigen::Index k = 0; k < H.rows(); ++k) {
    if (eigen.eigenvalues()[k] < kRankTolerance) continue;
    const Eigen::VectorXd v = scale.asDiagonal() * eigen.eigenvectors().col(k);
    out.inverse += v * v.transpose() / eigen.eigenvalues()[k];
    out.log_determinant += std::log(eigen.eigenvalues()[k]);
  }
  for (Eigen::Index k = 0; k < scale.size(); ++k) {
    if (scale[k] > 0) out.log_determinant -= 2 * std::log(scale[k]);
  }
  return out;
}

}  // namespace

BlockTridiagonal covarianceOf(const std::vector<NoiseComponent>& components) {
  BlockTridiagonal V(components.front().pattern.rows());
  for (const NoiseComponent& c : components) V.add(c.variance, c.pattern);
  return V;
}

void estimateVariances(const Eigen::VectorXd& r, const Eigen::MatrixXd& J, int iterations,
                       std::vector<NoiseComponent>* components) {
  for (int k = 0; k < iterations; ++k) {
    const BlockFactor factor(covarianceOf(*components));
    const BlockTridiagonal inverse = factor.inverseInPattern();
    const Eigen::MatrixXd W = factor.solve(J);
    const Eigen::MatrixXd H_inverse = pseudoInverse(J.transpose() * W).inverse;
    const Eigen::VectorXd b = factor.solve(r);
    const Eigen::VectorXd z = b - W * (H_inverse * (J.transpose() * b));  // P r
    for (NoiseComponent& c : *components) {
      const double found = quadraticForm(c.pattern, z)(0, 0);
      const double expected = traceOfProduct(inverse, c.pattern) -
                              H_inverse.cwiseProduct(quadraticForm(c.pattern, W)).sum();
      if (!(expected > 0)) continue;
      c.variance = std::max(c.floor, c.variance * std::sqrt(found / expected));
    }
  }
}

double restrictedLikelihood(const Eigen::VectorXd& r, const Eigen::MatrixXd& J,
                            const std::vector<NoiseComponent>& components) {
  const BlockFactor factor(covarianceOf(components));
  const Eigen::MatrixXd W = factor.solve(J);
  const Pseudo H = pseudoInverse(J.transpose() * W);
  const Eigen::VectorXd b = factor.solve(r);
  const Eigen::VectorXd z = b - W * (H.inverse * (J.transpose() * b));
  return -(factor.logDeterminant() + H.log_determinant + r.dot(z));
}

}  // namespace rf::calibration
