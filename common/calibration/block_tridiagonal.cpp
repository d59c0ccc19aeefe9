// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/block_tridiagonal.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace rf::calibration {
namespace {

constexpr int kBlock = 6;

Eigen::Index at(std::size_t row) { return static_cast<Eigen::Index>(kBlock * row); }

Mat6 choleskyOf(const Mat6& D, std::size_t row) {
  // Translations and rotations differ by orders of magnitude: factor the correlation matrix.
  const Vec6 sigma = D.diagonal().cwiseMax(0.0).cwiseSqrt();
  if (sigma.minCoeff() > 0) {
    const Vec6 inverse = sigma.cwiseInverse();
    const Eigen::LLT<Mat6> llt(inverse.asDiagonal() * D * inverse.asDiagonal());
    if (llt.info() == Eigen::Success) return sigma.asDiagonal() * Mat6(llt.matrixL());
  }
  throw std::invalid_argument("BlockFactor: block " + std::to_string(row) +
                              ": must be positive definite");
}

}  // namespace

void BlockTridiagonal::add(double factor, const BlockTridiagonal& other) {
  for (std::size_t i = 0; i < rows(); ++i) {
    diagonal[i] += factor * other.diagonal[i];
    if (i > 0) below[i] += factor * other.below[i];
  }
}

BlockFactor::BlockFactor(const BlockTridiagonal& V)
    : lower_(V.rows(), Mat6::Zero()), cholesky_(V.rows()) {
  for (std::size_t i = 0; i < V.rows(); ++i) {
    Mat6 D = V.diagonal[i];
    if (i > 0) {
      const auto C = cholesky_[i - 1].triangularView<Eigen::Lower>();
      const Mat6 half = C.solve(V.below[i].transpose());  // C^-1 B'
      lower_[i] = cholesky_[i - 1]
                      .transpose()
                      .triangularView<Eigen::Upper>()
                      .solve(half)
                      .transpose();  // B D^-1
      D -= half.transpose() * half;
    }
    cholesky_[i] = choleskyOf(D, i);
  }
}

Eigen::MatrixXd BlockFactor::whiten(const Eigen::MatrixXd& M) const {
  Eigen::MatrixXd E = M;
  for (std::size_t i = 1; i < lower_.size(); ++i) {
    E.middleRows<kBlock>(at(i)) -= lower_[i] * E.middleRows<kBlock>(at(i - 1));
  }
  for (std::size_t i = 0; i < lower_.size(); ++i) {
    E.middleRows<kBlock>(at(i)) =
        cholesky_[i].triangularView<Eigen::Lower>().solve(E.middleRows<kBlock>(at(i))).eval();
  }
  return E;
}

Eigen::MatrixXd BlockFactor::solve(const Eigen::MatrixXd& M) const {
  Eigen::MatrixXd E = whiten(M);
  for (std::size_t i = lower_.size(); i-- > 0;) {
    E.middleRows<kBlock>(at(i)) = cholesky_[i]
                                      .transpose()
                                      .triangularView<Eigen::Upper>()
                                      .solve(E.middleRows<kBlock>(at(i)))
                                      .eval();
    if (i + 1 < lower_.size()) {
      E.middleRows<kBlock>(at(i)) -= lower_[i + 1].transpose() * E.middleRows<kBlock>(at(i + 1));
    }
  }
  return E;
}

BlockTridiagonal BlockFactor::inverseInPattern() const {
  BlockTridiagonal Z(lower_.size());
  for (std::size_t i = lower_.size(); i-- > 0;) {
    const Mat6 half = cholesky_[i].triangularView<Eigen::Lower>().solve(Mat6::Identity());
    Z.diagonal[i] = half.transpose() * half;
    if (i + 1 < lower_.size()) {
      const Mat6& L = lower_[i + 1];
      Z.below[i + 1] = -Z.diagonal[i + 1] * L;
      Z.diagonal[i] += L.transpose() * Z.diagonal[i + 1] * L;
    }
  }
  return Z;
}

double BlockFactor::logDeterminant() const {
  double sum = 0;
  for (const Mat6& C : cholesky_) sum += 2 * C.diagonal().array().log().sum();
  return sum;
}

double traceOfProduct(const BlockTridiagonal& A, const BlockTridiagonal& B) {
  double sum = 0;
  for (std::size_t i = 0; i < A.rows(); ++i) {
    sum += A.diagonal[i].cwiseProduct(B.diagonal[i]).sum();
    if (i > 0) sum += 2 * A.below[i].cwiseProduct(B.below[i]).sum();
  }
  return sum;
}

Eigen::VectorXd product(const BlockTridiagonal& A, const Eigen::VectorXd& z) {
  Eigen::VectorXd out(z.size());
  for (std::size_t i = 0; i < A.rows(); ++i) {
    out.segment<kBlock>(at(i)) = A.diagonal[i] * z.segment<kBlock>(at(i));
    if (i == 0) continue;
    out.segment<kBlock>(at(i)) += A.below[i] * z.segment<kBlock>(at(i - 1));
    out.segment<kBlock>(at(i - 1)) += A.below[i].transpose() * z.segment<kBlock>(at(i));
  }
  return out;
}

Eigen::MatrixXd quadraticForm(const BlockTridiagonal& A, const Eigen::MatrixXd& Z) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(Z.cols(), Z.cols());
  for (std::size_t i = 0; i < A.rows(); ++i) {
    const Eigen::Matrix<double, kBlock, Eigen::Dynamic> here = Z.middleRows<kBlock>(at(i));
    sum.noalias() += here.transpose() * (A.diagonal[i] * here);
    if (i == 0) continue;
    const Eigen::MatrixXd cross = here.transpose() * (A.below[i] * Z.middleRows<kBlock>(at(i - 1)));
    sum += cross + cross.transpose();
  }
  return sum;
}

}  // namespace rf::calibration
