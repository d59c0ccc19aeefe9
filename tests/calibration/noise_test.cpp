// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibration/noise_average.hpp"
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

/// Rows of independent errors of one standard deviation.
NoiseForm independentRows(std::size_t rows, Eigen::Index parameters, sim::Random* random) {
  NoiseForm form;
  form.r = randomMatrix(static_cast<Eigen::Index>(6 * rows), 1, random);
  form.J = randomMatrix(static_cast<Eigen::Index>(6 * rows), parameters, random);
  BlockTridiagonal K(rows);
  for (Mat6& block : K.diagonal) block.setIdentity();
  form.components.push_back({"alone", 1, 1e-18, K});
  estimateVariances(form.r, form.J, 20, &form.components);
  return form;
}

TEST(NoiseAverage, OfOneVarianceIsStudents) {
  sim::Random random(7);
  for (const std::size_t rows : {3, 10, 200}) {
    const NoiseForm form = independentRows(rows, 2, &random);
    const Eigen::Matrix2d H = form.J.transpose() * form.J;
    const Eigen::Vector2d x = -H.ldlt().solve(form.J.transpose() * form.r);
    // With a flat prior of the standard deviation: Student's t with one degree of freedom less
    // than there are residuals left over.
    const double left = static_cast<double>(form.r.size()) - 2;
    const Eigen::Matrix2d expected =
        (form.r + form.J * x).squaredNorm() / (left - 3) * Eigen::Matrix2d(H.inverse());
    const NoiseAverage average = averageOverNoise({form});
    EXPECT_LT((average.change - x).norm(), 1e-9);
    EXPECT_LT((average.covariance - expected).norm(), 0.06 * expected.norm()) << rows << " rows";
    EXPECT_LT(average.by_noise.norm(), 1e-12) << "the mean does not depend on one variance";
  }
}

TEST(NoiseAverage, FormsCountByTheirLikelihood) {
  sim::Random random(8);
  const NoiseForm right = independentRows(60, 2, &random);
  NoiseForm wrong = right;  // says that errors of every other row are three times larger
  for (std::size_t i = 0; i < 60; i += 2) wrong.components[0].pattern.diagonal[i] *= 9;
  estimateVariances(wrong.r, wrong.J, 20, &wrong.components);
  const NoiseAverage one = averageOverNoise({right});
  const NoiseAverage both = averageOverNoise({right, wrong});
  EXPECT_GT(both.weights[0], 0.999);
  EXPECT_LT((both.covariance - one.covariance).norm(), 1e-3 * one.covariance.norm());
  const NoiseAverage same = averageOverNoise({right, right});
  EXPECT_NEAR(same.weights[0], 0.5, 1e-9);
}

TEST(NoiseAverage, TheSpreadBetweenFormsIsPartOfTheCovariance) {
  sim::Random random(9);
  // Two rows about one parameter each that contradict each other: whom to believe is not known.
  NoiseForm a = independentRows(20, 1, &random);
  a.J.setOnes();
  a.r.head(60).array() += 2;
  a.r.tail(60).array() -= 2;
  NoiseForm b = a;
  for (std::size_t i = 0; i < 10; ++i) {
    a.components[0].pattern.diagonal[i] *= 9;
    b.components[0].pattern.diagonal[10 + i] *= 9;
  }
  estimateVariances(a.r, a.J, 20, &a.components);
  estimateVariances(b.r, b.J, 20, &b.components);
  const NoiseAverage average = averageOverNoise({a, b});
  const double of_a = averageOverNoise({a}).change[0];
  const double of_b = averageOverNoise({b}).change[0];
  ASSERT_GT(std::abs(of_a - of_b), 1);
  const double w = average.weights[0];
  EXPECT_NEAR(average.change[0], w * of_a + (1 - w) * of_b, 1e-9);
  EXPECT_NEAR(average.by_noise(0, 0), w * (1 - w) * std::pow(of_a - of_b, 2), 1e-9);
}

}  // namespace
}  // namespace rf::calibration
