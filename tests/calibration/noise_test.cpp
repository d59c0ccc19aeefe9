// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibration/noise_components.hpp"
#include "simulation/random.hpp"

namespace rf::calibration {
namespace {

Eigen::MatrixXd dense(const BlockTridiagonal& A) {
  const auto n = static_cast<Eigen::Index>(6 * A.rows());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < A.rows(); ++i) {
    const auto at = static_cast<Eigen::Index>(6 * i);
    out.block<6, 6>(at, at) = A.diagonal[i];
    if (i == 0) continue;
    out.block<6, 6>(at, at - 6) = A.below[i];
    out.block<6, 6>(at - 6, at) = A.below[i].transpose();
  }
  return out;
}

Eigen::MatrixXd randomMatrix(Eigen::Index rows, Eigen::Index cols, sim::Random* random) {
  Eigen::MatrixXd M(rows, cols);
  for (Eigen::Index r = 0; r < rows; ++r) {
    for (Eigen::Index c = 0; c < cols; ++c) M(r, c) = random->normal();
  }
  return M;
}

/// Differences of a pose noise: the pattern of motions that share their poses.
BlockTridiagonal differences(std::size_t rows, sim::Random* random) {
  BlockTridiagonal K(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const Mat6 T = Mat6(randomMatrix(6, 6, random)) * 0.2 + Mat6::Identity();
    K.diagonal[i] = Mat6::Identity() + T * T.transpose();
    if (i > 0) K.below[i] = -T;
  }
  return K;
}

BlockTridiagonal walk(std::size_t rows) {
  BlockTridiagonal K(rows);
  for (std::size_t i = 0; i < rows; ++i)
    K.diagonal[i] = static_cast<double>(1 + i % 3) * Mat6::Identity();
  return K;
}

TEST(BlockTridiagonal, AgreesWithTheDenseMatrix) {
  sim::Random random(3);
  BlockTridiagonal V = differences(7, &random);
  V.add(0.5, walk(7));
  const Eigen::MatrixXd D = dense(V);
  const Eigen::MatrixXd M = randomMatrix(42, 3, &random);
  const BlockFactor factor(V);
  EXPECT_LT((factor.solve(M) - D.inverse() * M).norm(), 1e-10);
  const Eigen::MatrixXd W = factor.whiten(M);
  EXPECT_LT((W.transpose() * W - M.transpose() * D.inverse() * M).norm(), 1e-9);
  EXPECT_NEAR(factor.logDeterminant(), std::log(D.determinant()), 1e-9);
  EXPECT_LT((quadraticForm(V, M) - M.transpose() * D * M).norm(), 1e-9);
  EXPECT_NEAR(traceOfProduct(factor.inverseInPattern(), V), 42, 1e-9) << "trace of V^-1 V";
  const BlockTridiagonal K = walk(7);
  EXPECT_NEAR(traceOfProduct(factor.inverseInPattern(), K), (D.inverse() * dense(K)).trace(), 1e-9);
}

TEST(BlockTridiagonal, WhatIsNoCovarianceIsRefused) {
  BlockTridiagonal V(2);
  V.diagonal[0] = V.diagonal[1] = Mat6::Identity();
  V.below[1] = 2 * Mat6::Identity();
  EXPECT_THROW(BlockFactor{V}, std::invalid_argument);
  V.diagonal[0](3, 3) = 0;
  EXPECT_THROW(BlockFactor{V}, std::invalid_argument);
}

TEST(NoiseComponents, VariancesOfDrawnErrorsAreFound) {
  constexpr std::size_t kRows = 400;
  constexpr double kAlone = 4e-4;
  constexpr double kWalk = 1e-4;
  sim::Random random(5);
  std::vector<NoiseComponent> truth{{"alone", kAlone, 1e-18, differences(kRows, &random)},
                                    {"walk", kWalk, 1e-18, walk(kRows)}};
  const Eigen::LLT<Eigen::MatrixXd> llt(dense(covarianceOf(truth)));
  // A fit takes errors out along J: restricted likelihood counts that.
  const Eigen::MatrixXd J = randomMatrix(6 * kRows, 9, &random);
  const Eigen::VectorXd r = llt.matrixL() * randomMatrix(6 * kRows, 1, &random);
  std::vector<NoiseComponent> found = truth;
  found[0].variance = found[1].variance = 1e-2;
  double before = restrictedLikelihood(r, J, found);
  for (int k = 0; k < 20; ++k) {
    estimateVariances(r, J, 5, &found);
    const double now = restrictedLikelihood(r, J, found);
    EXPECT_GE(now, before - 1e-6) << "the updates must not lower the likelihood";
    before = now;
  }
  // 2400 rows: a variance is known to some per cent (2 sigma about 2 * sqrt(2 / 2400) = 6 %, more
  // for two that compete).
  EXPECT_NEAR(found[0].variance, kAlone, 0.15 * kAlone);
  EXPECT_NEAR(found[1].variance, kWalk, 0.2 * kWalk);
}

}  // namespace
}  // namespace rf::calibration
