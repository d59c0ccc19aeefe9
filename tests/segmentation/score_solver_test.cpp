// SPDX-License-Identifier: BSD-3-Clause
// Oracle: the score QP against Ceres on the same bounded problem; optimality conditions; gradient.
#include "segmentation/score_solver.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <ceres/ceres.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace rf {
namespace {

double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1.0p-53; }

struct Problem {
  std::vector<double> delta;
  std::vector<float> target, weight;
  Adjacency adjacency{0};
  double lambda = 2;

  Eigen::Index size() const { return static_cast<Eigen::Index>(delta.size()); }
  Eigen::MatrixXd M() const {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(size(), size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      const auto a = static_cast<std::size_t>(i);
      m(i, i) += 2 * lambda * static_cast<double>(weight[a]);
      for (Eigen::Index j = 0; j < size(); ++j) {
        if (!adjacency.joined(a, static_cast<std::size_t>(j))) continue;
        m(i, i) += 2 * lambda;
        m(i, j) -= 2 * lambda;
      }
    }
    return m;
  }
  Eigen::VectorXd q() const {
    Eigen::VectorXd out(size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      const auto a = static_cast<std::size_t>(i);
      out(i) =
          2 * lambda * static_cast<double>(weight[a]) * static_cast<double>(target[a]) - delta[a];
    }
    return out;
  }
  std::vector<float> solve() const { return solveScores(delta, target, weight, adjacency, lambda); }
  double energy(const std::vector<double>& gamma) const {
    return scoreEnergy(gamma, delta, target, weight, adjacency, lambda);
  }
};

Problem randomProblem(std::mt19937_64& random, std::size_t k) {
  Problem p;
  p.adjacency = Adjacency(k);
  p.lambda = 0.1 + 4 * uniform(random);
  const double density = uniform(random);
  for (std::size_t i = 0; i < k; ++i) {
    p.delta.push_back(20 * (uniform(random) - 0.5));
    // Targets are often exactly on a bound, as after a clear frame.
    const double t = uniform(random);
    p.target.push_back(static_cast<float>(t < 0.3 ? 0.0 : t > 0.7 ? 1.0 : t));
    p.weight.push_back(static_cast<float>(uniform(random) < 0.2 ? 0.01 : 0.3 + uniform(random)));
    for (std::size_t j = 0; j < i; ++j) {
      if (uniform(random) < density) p.adjacency.join(i, j);
    }
  }
  return p;
}

/// E as least squares |R x - R^-T q|^2 / 2 with M = R'R; every score is a parameter block.
class LeastSquares : public ceres::CostFunction {
 public:
  explicit LeastSquares(const Problem& p) : R_(p.M().llt().matrixU()) {
    rhs_ = R_.transpose().triangularView<Eigen::Lower>().solve(p.q());
    set_num_residuals(static_cast<int>(p.size()));
    mutable_parameter_block_sizes()->assign(static_cast<std::size_t>(p.size()), 1);
  }
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd> r(residuals, rhs_.size());
    r = -rhs_;
    for (Eigen::Index i = 0; i < rhs_.size(); ++i) {
      r += R_.col(i) * *x[i];
      if (jacobians != nullptr && jacobians[i] != nullptr) {
        Eigen::Map<Eigen::VectorXd>(jacobians[i], rhs_.size()) = R_.col(i);
      }
    }
    return true;
  }

 private:
  Eigen::MatrixXd R_;
  Eigen::VectorXd rhs_;
};

/// Ceres projects its Gauss-Newton step onto the box, and a projected Newton step need not descend
/// (it stalls on a third of these problems). So scores that rest on a bound and are pushed against
/// it are held there and the rest is solved again, until nothing changes: every pass lowers the
/// energy.
std::vector<double> solveWithCeres(const Problem& p) {
  std::vector<double> x(p.delta.size(), 0.5);
  std::vector<double*> blocks;
  for (double& value : x) blocks.push_back(&value);
  std::vector<bool> held(x.size(), false), before;
  for (int pass = 0; pass < 100 && held != before; ++pass) {
    ceres::Problem problem;
    problem.AddResidualBlock(new LeastSquares(p), nullptr, blocks);
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (held[i]) {
        problem.SetParameterBlockConstant(blocks[i]);
        continue;
      }
      problem.SetParameterLowerBound(blocks[i], 0, 0.0);
      problem.SetParameterUpperBound(blocks[i], 0, 1.0);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 200;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-16;
    options.initial_trust_region_radius = 1e12;
    // A projected Newton step that does not descend shrinks the region; from 1e12 that takes many.
    options.max_num_consecutive_invalid_steps = 100;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    const Eigen::VectorXd gradient =
        p.M() * Eigen::Map<Eigen::VectorXd>(x.data(), p.size()) - p.q();
    before = held;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double g = gradient(static_cast<Eigen::Index>(i));
      held[i] = (x[i] <= 0 && g > 0) || (x[i] >= 1 && g < 0);
    }
  }
  return x;
}

TEST(ScoreSolver, EqualsCeresOnTheSameBoundedProblem) {
  // Ceres stops its projected search at about 1e-6; the energy cannot be below the exact minimum.
  constexpr double kCeresPrecision = 2e-5;
  std::mt19937_64 random(1);
  for (int round = 0; round < 400; ++round) {
    const Problem p = randomProblem(random, 1 + random() % 30);
    const std::vector<float> gamma = p.solve();
    const std::vector<double> oracle = solveWithCeres(p);
    const double exact = p.energy({gamma.begin(), gamma.end()});
    ASSERT_LE(exact, p.energy(oracle) + 1e-6) << "round " << round;
    for (std::size_t i = 0; i < gamma.size(); ++i) {
      ASSERT_NEAR(gamma[i], oracle[i], kCeresPrecision)
          << "round " << round << " cluster " << i << " of " << gamma.size() << ": energy " << exact
          << ", by Ceres " << p.energy(oracle);
    }
  }
}

TEST(ScoreSolver, MeetsTheOptimalityConditions) {
  constexpr double kFloatRounding = 2e-4;  // scores are floats, curvatures up to some 200
  std::mt19937_64 random(2);
  for (int round = 0; round < 2000; ++round) {
    const Problem p = randomProblem(random, 24);
    const std::vector<float> gamma = p.solve();
    Eigen::VectorXd x(p.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = gamma[static_cast<std::size_t>(i)];
    const Eigen::VectorXd gradient = p.M() * x - p.q();
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      ASSERT_GE(x(i), 0.0);
      ASSERT_LE(x(i), 1.0);
      if (x(i) > 0) {
        ASSERT_LE(gradient(i), kFloatRounding) << "round " << round;
      }
      if (x(i) < 1) {
        ASSERT_GE(gradient(i), -kFloatRounding) << "round " << round;
      }
    }
  }
}

TEST(ScoreSolver, BothActiveSetsFindTheSameMinimum) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 500; ++round) {
    const Problem p = randomProblem(random, 24);
    const std::vector<float> gamma = p.solve();
    const Eigen::VectorXd primal = solveBoxPrimal(p.M(), p.q());
    for (std::size_t i = 0; i < gamma.size(); ++i) {
      ASSERT_NEAR(gamma[i], primal(static_cast<Eigen::Index>(i)), 1e-6) << "round " << round;
    }
  }
}

TEST(ScoreSolver, EnergysDifferencesEqualItsGradient) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 50; ++round) {
    const Problem p = randomProblem(random, 12);
    std::vector<double> gamma(12);
    for (double& g : gamma) g = uniform(random);
    const Eigen::VectorXd gradient = p.M() * Eigen::Map<Eigen::VectorXd>(gamma.data(), 12) - p.q();
    for (std::size_t i = 0; i < gamma.size(); ++i) {
      constexpr double kStep = 1e-4;
      std::vector<double> plus = gamma, minus = gamma;
      plus[i] += kStep;
      minus[i] -= kStep;
      const double difference = (p.energy(plus) - p.energy(minus)) / (2 * kStep);
      ASSERT_NEAR(difference, gradient(static_cast<Eigen::Index>(i)), 1e-5);
    }
  }
}

TEST(ScoreSolver, VariablesExactlyOnTheirBoundsDoNotCycle) {
  Problem p;
  p.adjacency = Adjacency(6);
  for (std::size_t i = 0; i + 1 < 6; ++i) p.adjacency.join(i, i + 1);
  p.delta.assign(6, 0.0);
  p.weight.assign(6, 1.0F);
  p.target.assign(6, 0.0F);
  for (float g : p.solve()) EXPECT_EQ(g, 0.0F);
  p.target.assign(6, 1.0F);
  for (float g : p.solve()) EXPECT_NEAR(g, 1.0F, 1e-7F);
}

TEST(ScoreSolver, EmptyAndBadInput) {
  EXPECT_TRUE(solveScores({}, {}, {}, Adjacency(0), 2).empty());
  EXPECT_THROW(solveScores({1.0}, {}, {1.0F}, Adjacency(1), 2), std::invalid_argument);
  EXPECT_THROW(solveScores({1.0}, {1.0F}, {1.0F}, Adjacency(2), 2), std::invalid_argument);
  EXPECT_THROW(solveScores({1.0}, {1.0F}, {1.0F}, Adjacency(1), 0), std::invalid_argument);
  EXPECT_THROW(
      solveScores({std::numeric_limits<double>::quiet_NaN()}, {1.0F}, {1.0F}, Adjacency(1), 2),
      std::invalid_argument);
}

}  // namespace
}  // namespace rf
