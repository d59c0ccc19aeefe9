// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/score_solver.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace rf {
namespace {

constexpr int kActiveSetRounds = 50;   // 5 sufficed on thousands of random problems
constexpr double kTolerance = 1e-12;   // of bounds and multipliers
constexpr float kLeastWeight = 1e-6F;  // keeps M positive definite

struct Quadratic {
  Eigen::MatrixXd M;  ///< gradient = M gamma - q
  Eigen::VectorXd q;
};

Quadratic build(const std::vector<double>& delta, const std::vector<float>& target,
                const std::vector<float>& weight, const Adjacency& adjacency, double lambda_r) {
  const auto n = static_cast<Eigen::Index>(delta.size());
  Quadratic out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double w = static_cast<double>(std::max(weight[k], kLeastWeight));
    out.M(i, i) += 2 * lambda_r * w;
    out.q(i) = 2 * lambda_r * w * static_cast<double>(target[k]) - delta[k];
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!adjacency.joined(k, static_cast<std::size_t>(j))) continue;
      out.M(i, i) += 2 * lambda_r;
      out.M(i, j) -= 2 * lambda_r;
    }
  }
  return out;
}

enum class Set : unsigned char { kFree, kLow, kHigh };

/// Minimises over the free variables, the others at their bounds.
Eigen::VectorXd minimiserWithin(const Eigen::MatrixXd& M, const Eigen::VectorXd& q,
                                const std::vector<Set>& set) {
  std::vector<Eigen::Index> free;
  Eigen::VectorXd gamma(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Set s = set[static_cast<std::size_t>(i)];
    if (s == Set::kFree) free.push_back(i);
    gamma(i) = s == Set::kHigh ? 1.0 : 0.0;
  }
  if (free.empty()) return gamma;
  const Eigen::VectorXd rhs = (q - M * gamma)(free);
  const Eigen::VectorXd x = Eigen::MatrixXd(M(free, free)).llt().solve(rhs);
  gamma(free) = x;
  return gamma;
}

/// True when the sets settled: then gamma is the exact minimiser. Signs below the tolerance are
/// rounding; without it a variable exactly on its bound could change sides for ever.
bool activeSet(const Quadratic& problem, Eigen::VectorXd& gamma) {
  std::vector<Set> set(static_cast<std::size_t>(gamma.size()), Set::kFree);
  for (int round = 0; round < kActiveSetRounds; ++round) {
    gamma = minimiserWithin(problem.M, problem.q, set);
    const Eigen::VectorXd mu = problem.M * gamma - problem.q;
    std::vector<Set> next = set;
    for (Eigen::Index i = 0; i < gamma.size(); ++i) {
      Set& s = next[static_cast<std::size_t>(i)];
      if (s == Set::kFree) {
        s = gamma(i) < -kTolerance ? Set::kLow : (gamma(i) > 1 + kTolerance ? Set::kHigh : s);
      } else if ((s == Set::kLow && mu(i) < -kTolerance) ||
                 (s == Set::kHigh && mu(i) > kTolerance)) {
        s = Set::kFree;
      }
    }
    if (next == set) return true;
    set = std::move(next);
  }
  return false;
}

/// The largest part of `step` that keeps the free variables inside the box; `blocking` names the
/// variable that stops it, or -1.
double feasibleLength(const Eigen::VectorXd& gamma, const Eigen::VectorXd& step,
                      const std::vector<Set>& set, Eigen::Index& blocking) {
  double length = 1.0;
  blocking = -1;
  for (Eigen::Index i = 0; i < gamma.size(); ++i) {
    if (set[static_cast<std::size_t>(i)] != Set::kFree || step(i) == 0.0) continue;
    const double room = step(i) > 0 ? 1.0 - gamma(i) : -gamma(i);
    const double l = std::max(0.0, room / step(i));
    if (l < length) {
      length = l;
      blocking = i;
    }
  }
  return length;
}

/// The bound whose multiplier has the wrong sign most, or -1 at the minimiser.
Eigen::Index worstBound(const Eigen::VectorXd& mu, const std::vector<Set>& set) {
  double worst = kTolerance;
  Eigen::Index index = -1;
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    const Set s = set[static_cast<std::size_t>(i)];
    const double wrong = s == Set::kLow ? -mu(i) : (s == Set::kHigh ? mu(i) : 0.0);
    if (wrong > worst) {
      worst = wrong;
      index = i;
    }
  }
  return index;
}

}  // namespace

Eigen::VectorXd solveBoxPrimal(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
  const Eigen::Index n = q.size();
  std::vector<Set> set(static_cast<std::size_t>(n), Set::kFree);
  Eigen::VectorXd gamma = Eigen::VectorXd::Constant(n, 0.5);
  const int most = 100 + 20 * static_cast<int>(n);  // a backstop far above what is ever needed
  for (int round = 0; round < most; ++round) {
    const Eigen::VectorXd step = minimiserWithin(M, q, set) - gamma;
    Eigen::Index blocking = -1;
    const double length = feasibleLength(gamma, step, set, blocking);
    gamma = (gamma + length * step).cwiseMax(0.0).cwiseMin(1.0);
    if (blocking >= 0) {
      const bool up = step(blocking) > 0;
      gamma(blocking) = up ? 1.0 : 0.0;
      set[static_cast<std::size_t>(blocking)] = up ? Set::kHigh : Set::kLow;
      continue;
    }
    const Eigen::Index release = worstBound(M * gamma - q, set);
    if (release < 0) break;
    set[static_cast<std::size_t>(release)] = Set::kFree;
  }
  return gamma;
}

std::vector<float> solveScores(const std::vector<double>& delta, const std::vector<float>& target,
                               const std::vector<float>& weight, const Adjacency& adjacency,
                               double lambda_r) {
  const std::size_t n = delta.size();
  if (target.size() != n || weight.size() != n || adjacency.count() != n) {
    throw std::invalid_argument("solveScores: delta, target, weight and adjacency differ in size");
  }
  if (!(lambda_r > 0) || !std::isfinite(lambda_r)) {
    throw std::invalid_argument("solveScores: lambda_r = " + std::to_string(lambda_r) +
                                " must be > 0");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(delta[i]) || !std::isfinite(target[i]) || !std::isfinite(weight[i])) {
      throw std::invalid_argument("solveScores: value " + std::to_string(i) + " is not finite");
    }
  }
  if (n == 0) return {};
  const Quadratic problem = build(delta, target, weight, adjacency, lambda_r);
  Eigen::VectorXd gamma = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n));
  if (!activeSet(problem, gamma)) gamma = solveBoxPrimal(problem.M, problem.q);
  std::vector<float> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = static_cast<float>(std::clamp(gamma(static_cast<Eigen::Index>(i)), 0.0, 1.0));
  }
  return out;
}

double scoreEnergy(const std::vector<double>& gamma, const std::vector<double>& delta,
                   const std::vector<float>& target, const std::vector<float>& weight,
                   const Adjacency& adjacency, double lambda_r) {
  double energy = 0;
  for (std::size_t i = 0; i < gamma.size(); ++i) {
    const double pull = gamma[i] - static_cast<double>(target[i]);
    energy += delta[i] * gamma[i] +
              lambda_r * static_cast<double>(std::max(weight[i], kLeastWeight)) * pull * pull;
    for (std::size_t j = i + 1; j < gamma.size(); ++j) {
      if (adjacency.joined(i, j))
        energy += lambda_r * (gamma[i] - gamma[j]) * (gamma[i] - gamma[j]);
    }
  }
  return energy;
}

}  // namespace rf
