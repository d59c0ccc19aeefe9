// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/observability.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace rf::calibration {
namespace {

constexpr double kRounding = 1e-15;  ///< of the largest eigenvalue: smaller ones are rounding

std::vector<int> indicesOf(const ParameterMask& mask) {
  std::vector<int> indices;
  for (int k = 0; k < kParameters; ++k) {
    if (mask[static_cast<std::size_t>(k)]) indices.push_back(k);
  }
  return indices;
}

Eigen::MatrixXd whitened(const ParameterMatrix& information, const ParameterVector& sigmas) {
  return sigmas.asDiagonal() * information * sigmas.asDiagonal();
}

}  // namespace

Observability observe(const ParameterMatrix& information, const ParameterVector& prior_sigmas,
                      const ParameterMask& active) {
  const std::vector<int> indices = indicesOf(active);
  const Eigen::MatrixXd A = whitened(information, prior_sigmas)(indices, indices);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
  const double rounding = kRounding * std::max(0.0, eigen.eigenvalues().maxCoeff());
  Observability out;
  for (Eigen::Index k = 0; k < A.rows(); ++k) {
    Direction d;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      d.vector[indices[i]] = eigen.eigenvectors()(static_cast<Eigen::Index>(i), k);
    }
    d.gain = std::sqrt(std::max(0.0, eigen.eigenvalues()[k]));
    d.observed = d.gain >= kObservedGain && eigen.eigenvalues()[k] > rounding;
    const ParameterVector v = prior_sigmas.cwiseInverse().asDiagonal() * d.vector;
    if (d.observed) {
      out.share += d.vector.cwiseAbs2();
    } else {
      out.prior_information += v * v.transpose();
    }
    out.directions.push_back(d);
  }
  return out;
}

bool observesAny(const ParameterMatrix& information, const ParameterVector& prior_sigmas,
                 const ParameterMask& active, ParameterGroup group) {
  ParameterMask others = active;
  const ParameterMask own = maskOf(group);
  for (std::size_t k = 0; k < own.size(); ++k) others[k] = active[k] && !own[k];
  const std::vector<int> g = indicesOf(own);
  const std::vector<int> o = indicesOf(others);
  const Eigen::MatrixXd A = whitened(information, prior_sigmas);
  Eigen::MatrixXd marginal = A(g, g);
  if (!o.empty()) {
    const Eigen::MatrixXd B = A(o, g);
    const Eigen::MatrixXd C =
        Eigen::MatrixXd(A(o, o)) + Eigen::MatrixXd::Identity(static_cast<Eigen::Index>(o.size()),
                                                             static_cast<Eigen::Index>(o.size()));
    marginal -= B.transpose() * C.ldlt().solve(B);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(marginal);
  return eigen.eigenvalues().maxCoeff() >= kObservedGain * kObservedGain;
}

}  // namespace rf::calibration
