// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/se3.hpp"

namespace rf::calibration {

/// A symmetric matrix of 6x6 blocks in which only neighbouring rows are coupled: the covariance of
/// motions over adjoining times, which share the pose where they meet.
struct BlockTridiagonal {
  std::vector<Mat6> diagonal;
  std::vector<Mat6> below;  ///< below[i]: block (i, i-1); below[0] is not used

  explicit BlockTridiagonal(std::size_t rows = 0)
      : diagonal(rows, Mat6::Zero()), below(rows, Mat6::Zero()) {}
  std::size_t rows() const { return diagonal.size(); }
  void add(double factor, const BlockTridiagonal& other);
};

/// Factors V = L D L' of a positive definite V.
class BlockFactor {
 public:
  /// Throws std::invalid_argument when V is not positive definite.
  explicit BlockFactor(const BlockTridiagonal& V);

  /// D^-1/2 L^-1 M: rows of unit covariance. M has 6 * rows() rows.
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& M) const;
  /// V^-1 M.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& M) const;
  /// Those blocks of V^-1 that lie in the pattern (Takahashi's recursion).
  BlockTridiagonal inverseInPattern() const;
  double logDeterminant() const;

 private:
  std::vector<Mat6> lower_;     ///< L_i, block (i, i-1)
  std::vector<Mat6> cholesky_;  ///< C_i, lower, D_i = C_i C_i'
};

/// Sum over all entries of A .* B, = trace(A B) for symmetric matrices.
double traceOfProduct(const BlockTridiagonal& A, const BlockTridiagonal& B);
/// A z for a vector of 6 * rows() entries.
Eigen::VectorXd product(const BlockTridiagonal& A, const Eigen::VectorXd& z);
/// Z' A Z for a matrix of 6 * rows() rows.
Eigen::MatrixXd quadraticForm(const BlockTridiagonal& A, const Eigen::MatrixXd& Z);

}  // namespace rf::calibration
