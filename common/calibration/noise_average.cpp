// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/noise_average.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace rf::calibration {
namespace {

constexpr int kPairs = 32;          ///< of samples and their mirror images, per form
constexpr double kFreedom = 5;      ///< of the Student t
constexpr double kNegligible = 15;  ///< natural logarithm: forms that much less likely are left out
constexpr double kLeastCurvature = 0.05;  ///< of a direction, beside 1 for a cause alone
constexpr std::uint64_t kSequence = 20240229;

/// What the parameters are when the noise is known.
struct Conditional {
  double log_likelihood = -std::numeric_limits<double>::infinity();
  Eigen::VectorXd change;
  Eigen::MatrixXd covariance;
};

Conditional conditionalOn(const NoiseForm& form, const Eigen::VectorXd& sigmas) {
  BlockTridiagonal V(form.components.front().pattern.rows());
  for (std::size_t c = 0; c < form.components.size(); ++c) {
    const double s = sigmas[static_cast<Eigen::Index>(c)];
    V.add(std::max(form.components[c].floor, s * s), form.components[c].pattern);
  }
  const BlockFactor factor(V);
  const Eigen::MatrixXd W = factor.whiten(form.J);
  const Eigen::VectorXd w = factor.whiten(form.r);
  const Eigen::LLT<Eigen::MatrixXd> llt(W.transpose() * W);
  if (llt.info() != Eigen::Success) return {};
  const Eigen::VectorXd g = W.transpose() * w;
  Conditional out;
  out.change = -llt.solve(g);
  out.covariance = llt.solve(Eigen::MatrixXd::Identity(g.size(), g.size()));
  const double determinant = 2 * Eigen::MatrixXd(llt.matrixL()).diagonal().array().log().sum();
  out.log_likelihood =
      -0.5 * (factor.logDeterminant() + determinant + w.squaredNorm() + g.dot(out.change));
  return out;
}

/// Curvature of the log likelihood in the standard deviations, negated: 4 s_i s_j times the average
/// information of the variances, less twice the score on the diagonal, which is what there is at
/// a standard deviation of zero.
Eigen::MatrixXd curvatureAt(const NoiseForm& form, const Eigen::VectorXd& sigmas) {
  const BlockFactor factor(covarianceOf(form.components));
  const BlockTridiagonal inverse = factor.inverseInPattern();
  const Eigen::MatrixXd W = factor.solve(form.J);
  const Eigen::MatrixXd H_inverse =
      (form.J.transpose() * W).ldlt().solve(Eigen::MatrixXd::Identity(W.cols(), W.cols()));
  const auto project = [&](const Eigen::MatrixXd& M) -> Eigen::MatrixXd {
    return factor.solve(M) - W * (H_inverse * (W.transpose() * M));
  };
  const Eigen::VectorXd z = project(form.r);
  const auto n = static_cast<Eigen::Index>(form.components.size());
  Eigen::MatrixXd U(z.size(), n);
  Eigen::VectorXd score(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const BlockTridiagonal& K = form.components[static_cast<std::size_t>(i)].pattern;
    U.col(i) = product(K, z);
    const double expected =
        traceOfProduct(inverse, K) - H_inverse.cwiseProduct(quadraticForm(K, W)).sum();
    score[i] = 0.5 * (z.dot(U.col(i)) - expected);
  }
  Eigen::MatrixXd curvature =
      2 * sigmas.asDiagonal() * (U.transpose() * project(U)) * sigmas.asDiagonal();
  curvature.diagonal() -= 2 * score.cwiseMin(0.0);
  return curvature;
}

/// A Student t about the maximum, folded to positive standard deviations.
class Proposal {
 public:
  Proposal(Eigen::VectorXd centre, const Eigen::MatrixXd& curvature) : centre_(std::move(centre)) {
    // Scaled to unit diagonal; directions in which causes exchange are not followed without end.
    const Eigen::VectorXd scale = curvature.diagonal().cwiseSqrt();
    scale_ = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale_.asDiagonal() * curvature *
                                                               scale_.asDiagonal());
    const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(kLeastCurvature);
    root_ = eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal();
    inverse_root_ = values.cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
    log_determinant_ = 0.5 * values.array().log().sum();
    for (const double s : scale_) log_determinant_ -= s > 0 ? std::log(s) : 0;
  }

  /// From n unit normals that are stretched together into a Student t.
  Eigen::VectorXd at(const Eigen::VectorXd& unit) const {
    return (centre_ + scale_.asDiagonal() * (root_ * unit)).cwiseAbs();
  }

  /// Logarithm of the density, up to a constant that all forms with n components share.
  double logDensity(const Eigen::VectorXd& sigmas) const {
    const Eigen::Index n = sigmas.size();
    double sum = 0;
    for (unsigned flips = 0; flips < (1U << static_cast<unsigned>(n)); ++flips) {
      Eigen::VectorXd d = sigmas;
      for (Eigen::Index k = 0; k < n; ++k) {
        if ((flips >> static_cast<unsigned>(k) & 1U) != 0) d[k] = -d[k];
        d[k] = scale_[k] > 0 ? (d[k] - centre_[k]) / scale_[k] : 0;
      }
      const double q = (inverse_root_ * d).squaredNorm();
      sum += std::pow(1 + q / kFreedom, -0.5 * (kFreedom + static_cast<double>(n)));
    }
    return log_determinant_ + std::log(sum);
  }

 private:
  Eigen::VectorXd centre_, scale_;
  Eigen::MatrixXd root_, inverse_root_;
  double log_determinant_ = 0;
};

Eigen::VectorXd sigmasOf(const NoiseForm& form) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(form.components.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    out[i] = std::sqrt(form.components[static_cast<std::size_t>(i)].variance);
  }
  return out;
}

struct Sample {
  std::size_t form = 0;
  double log_weight = 0;
  Conditional parameters;
};

void drawSamples(const NoiseForm& form, std::size_t index, std::vector<Sample>* out) {
  const Eigen::VectorXd mode = sigmasOf(form);
  const Proposal proposal(mode, curvatureAt(form, mode));
  std::mt19937_64 random(kSequence);
  std::normal_distribution<double> normal;
  std::chi_squared_distribution<double> chi(kFreedom);
  for (int k = 0; k < kPairs; ++k) {
    Eigen::VectorXd unit(mode.size());
    for (double& u : unit) u = normal(random);
    unit *= std::sqrt(kFreedom / chi(random));
    for (const double side : {1.0, -1.0}) {
      const Eigen::VectorXd sigmas = proposal.at(side * unit);
      Sample s{index, 0, conditionalOn(form, sigmas)};
      s.log_weight = s.parameters.log_likelihood - proposal.logDensity(sigmas);
      if (std::isfinite(s.log_weight)) out->push_back(std::move(s));
    }
  }
}

}  // namespace

NoiseAverage averageOverNoise(const std::vector<NoiseForm>& forms) {
  std::vector<double> best;
  best.reserve(forms.size());
  for (const NoiseForm& form : forms) {
    best.push_back(conditionalOn(form, sigmasOf(form)).log_likelihood);
  }
  const double top = *std::max_element(best.begin(), best.end());
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    if (best[i] > top - kNegligible) drawSamples(forms[i], i, &samples);
  }
  double largest = -std::numeric_limits<double>::infinity();
  for (const Sample& s : samples) largest = std::max(largest, s.log_weight);
  const Eigen::Index p = forms.front().J.cols();
  NoiseAverage out{Eigen::VectorXd::Zero(p), Eigen::MatrixXd::Zero(p, p),
                   Eigen::MatrixXd::Zero(p, p), std::vector<double>(forms.size(), 0)};
  double sum = 0;
  for (const Sample& s : samples) {
    const double weight = std::exp(s.log_weight - largest);
    sum += weight;
    out.weights[s.form] += weight;
    out.change += weight * s.parameters.change;
    out.covariance += weight * s.parameters.covariance;
  }
  out.change /= sum;
  out.covariance /= sum;
  for (double& w : out.weights) w /= sum;
  for (const Sample& s : samples) {
    const Eigen::VectorXd d = s.parameters.change - out.change;
    out.by_noise += std::exp(s.log_weight - largest) / sum * d * d.transpose();
  }
  out.covariance += out.by_noise;
  return out;
}

}  // namespace rf::calibration
