// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/estimator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "calibration/noise_average.hpp"
#include "calibration/whitened_solver.hpp"

namespace rf::calibration {
namespace {

constexpr int kRobustPasses = 3;
constexpr int kRounds = 5;
/// What is not observed stays at its prior, however the noise would pull.
constexpr double kHold = 1e6;
constexpr int kFirstIterations = 40;      ///< of the variances
constexpr int kLaterIterations = 15;      ///< in each round after
constexpr double kMedianOfSix = 5.348;    ///< median of chi-squared with 6 degrees of freedom
constexpr double kContradiction = 40.0;   ///< chi-squared with 6: exceeded once in two million
constexpr double kSmallestScale = 1e-10;  ///< of variances: perfect data
/// Twice the logarithm: forms of noise that much less likely than the best are left out.
constexpr double kUnlikely = 40;
constexpr std::size_t kBlocks = 20;  ///< of the test for errors that last

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> squaredRows(const Eigen::VectorXd& whitened) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < whitened.size(); i += 6) {
    out.push_back(whitened.segment<6>(i).squaredNorm());
  }
  return out;
}

/// Rows seen one by one, with their own covariance alone.
BlockTridiagonal diagonalOf(const BlockTridiagonal& V) {
  BlockTridiagonal out(V.rows());
  out.diagonal = V.diagonal;
  return out;
}

/// What is known before the noise is: nothing, where there is no transform to hold on to.
ParameterMatrix weakPrior(const CalibrationPrior& prior) {
  ParameterVector precision = prior.sigmas().cwiseAbs2().cwiseInverse();
  if (!prior.has_transform) precision.head<6>() *= 1e-3;
  return precision.asDiagonal();
}

struct RobustFit {
  CalibrationValues values;
  std::vector<bool> used;
  double scale = 1;  ///< of the nominal variances, to fit the residuals
};

/// Values from nominal noise and a robust loss; marks rows far outside.
RobustFit robustFit(const RowModel& model, const CalibrationValues& start,
                    const CalibrationPrior& prior, const ParameterMask& active) {
  const ParameterMatrix weak = weakPrior(prior);
  RobustFit fit{start, std::vector<bool>(model.rows(), true), 1};
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    BlockTridiagonal V(model.rows());
    V.add(fit.scale, covarianceOf(model.noise(fit.values)));
    const BlockFactor factor(diagonalOf(V));
    fit.values = solveRobust(model, factor, fit.values, prior, weak, active);
    Eigen::VectorXd r;
    model.evaluate(fit.values, &r, nullptr);
    const std::vector<double> squares = squaredRows(factor.whiten(r));
    const double found = std::max(kSmallestScale / fit.scale, median(squares) / kMedianOfSix);
    fit.scale *= found;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      fit.used[i] = squares[i] <= kContradiction * found;
    }
  }
  return fit;
}

RobustFit bestFit(const RowModel& model, const std::vector<CalibrationValues>& starts,
                  const CalibrationPrior& prior, const ParameterMask& active) {
  RobustFit best = robustFit(model, starts.front(), prior, active);
  for (std::size_t i = 1; i < starts.size(); ++i) {
    RobustFit fit = robustFit(model, starts[i], prior, active);
    if (fit.scale < best.scale) best = std::move(fit);
  }
  return best;
}

/// Columns span what is observed.
Eigen::MatrixXd observedBasis(const Observability& observability, const ParameterVector& sigmas) {
  Eigen::MatrixXd basis(kParameters, 0);
  for (const Direction& d : observability.directions) {
    if (!d.observed) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.col(basis.cols() - 1) = sigmas.asDiagonal() * d.vector;
  }
  return basis;
}

/// How much more the sum of scores varies over blocks of time than the model says, as a factor on
/// the variance; 1 unless that is beyond chance.
double wideningOf(const Eigen::VectorXd& r, const Eigen::MatrixXd& J, const ParameterMatrix& H,
                  const Observability& observability, const ParameterVector& sigmas) {
  const Eigen::Index rows = r.size() / 6;
  const auto blocks = std::min<Eigen::Index>(kBlocks, rows / 4);
  const Eigen::MatrixXd basis = observedBasis(observability, sigmas);
  const Eigen::Index p = basis.cols();
  if (p == 0 || blocks < 4) return 1;
  const Eigen::MatrixXd whole = basis.transpose() * H * basis;
  const Eigen::LLT<Eigen::MatrixXd> llt(whole);
  if (llt.info() != Eigen::Success) return 1;
  double found = 0;
  double expected = 0;
  double variance = 0;
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index from = 6 * (rows * b / blocks);
    const Eigen::Index size = 6 * (rows * (b + 1) / blocks) - from;
    const Eigen::MatrixXd Jb = J.middleRows(from, size) * basis;
    const Eigen::VectorXd g = llt.matrixL().solve(Jb.transpose() * r.segment(from, size));
    const Eigen::MatrixXd half = llt.matrixL().solve(Jb.transpose());
    const Eigen::MatrixXd share = half * half.transpose();  // of the information, sums to identity
    const Eigen::MatrixXd left = share - share * share;     // the fit takes its own part out
    found += g.squaredNorm();
    expected += left.trace();
    variance += 2 * left.squaredNorm();
  }
  if (found <= expected + 2 * std::sqrt(variance)) return 1;
  return found / expected;
}

/// One form of the noise, with its variances as far as they are known.
struct Form {
  const RowModel* model = nullptr;
  std::unique_ptr<RowModel> rows;  ///< those in use
  std::vector<NoiseComponent> noise;
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  double likelihood = 0;
};

void evaluate(const CalibrationValues& values, const ParameterMask& active, Form* form) {
  form->rows->evaluate(values, &form->r, &form->J);
  for (int k = 0; k < kParameters; ++k) {
    if (!active[static_cast<std::size_t>(k)]) form->J.col(k).setZero();
  }
}

/// Variances of the form at the values, from the rows in use; `noise` has those to start from.
void fitNoise(const Estimate& e, const ParameterMask& active, int iterations, Form* form) {
  form->rows = form->model->subset(e.used);
  std::vector<NoiseComponent> noise = form->rows->noise(e.values);
  for (std::size_t c = 0; c < noise.size(); ++c) noise[c].variance = form->noise[c].variance;
  form->noise = std::move(noise);
  evaluate(e.values, active, form);
  estimateVariances(form->r, form->J, iterations, &form->noise);
  form->likelihood = restrictedLikelihood(form->r, form->J, form->noise);
}

/// The likeliest form goes first; those that can no longer matter are left out.
void rank(std::vector<Form>* forms) {
  std::stable_sort(forms->begin(), forms->end(),
                   [](const Form& a, const Form& b) { return a.likelihood > b.likelihood; });
  const double least = forms->front().likelihood - kUnlikely;
  std::erase_if(*forms, [&](const Form& form) { return form.likelihood < least; });
}

void recordSurprise(const std::vector<double>& squares, Estimate* e) {
  std::size_t row = 0;
  for (std::size_t i = 0; i < e->used.size(); ++i) {
    if (e->used[i]) e->surprise[i] = squares[row++];
  }
}

/// Leaves rows out that contradict the rest.
void rejectContradictions(Estimate* e) {
  for (std::size_t i = 0; i < e->used.size(); ++i) {
    if (e->surprise[i] > kContradiction) e->used[i] = false;
  }
}

/// Replaces values and covariance of what is observed by their mean over all that the noise may be.
void averageOver(std::vector<Form>* forms, const CalibrationPrior& prior,
                 const ParameterMask& active, Estimate* e) {
  const Eigen::MatrixXd basis = observedBasis(e->observability, prior.sigmas());
  if (basis.cols() == 0) return;
  std::vector<NoiseForm> possible;
  for (Form& form : *forms) {
    evaluate(e->values, active, &form);
    possible.push_back({form.r, form.J * basis, std::move(form.noise)});
  }
  const NoiseAverage average = averageOverNoise(possible);
  e->values = plus(e->values, basis * average.change);
  const Eigen::MatrixXd covariance =
      e->widening * (average.covariance - average.by_noise) + average.by_noise;
  e->covariance += basis * covariance * basis.transpose();
  e->noise = std::move(possible.front().components);
}

}  // namespace

Estimate estimate(const RowModel& model, const std::vector<CalibrationValues>& starts,
                  const CalibrationPrior& prior, const ParameterMask& active) {
  RobustFit fit = bestFit(model, starts, prior, active);
  Estimate e;
  e.surprise.assign(model.rows(), 0);
  e.used = std::move(fit.used);
  e.values = fit.values;
  const std::vector<std::unique_ptr<RowModel>> others = model.otherForms();
  std::vector<Form> forms(1 + others.size());
  for (std::size_t f = 0; f < forms.size(); ++f) {
    forms[f].model = f == 0 ? &model : others[f - 1].get();
    forms[f].noise = forms[f].model->noise(e.values);
    for (NoiseComponent& c : forms[f].noise) c.variance *= fit.scale;
  }
  for (int k = 0; k < kRounds; ++k) {
    for (Form& form : forms) {
      fitNoise(e, active, k == 0 ? kFirstIterations : kLaterIterations, &form);
    }
    rank(&forms);
    Form& best = forms.front();
    const BlockFactor factor(covarianceOf(best.noise));
    Eigen::MatrixXd W = factor.whiten(best.J);
    e.information = W.transpose() * W;
    e.observability = observe(e.information / e.widening, prior.sigmas(), active);
    e.values = solveWhitened(*best.rows, factor, e.values, prior,
                             kHold * e.observability.prior_information, active, &e.converged);
    evaluate(e.values, active, &best);
    W = factor.whiten(best.J);
    const Eigen::VectorXd w = factor.whiten(best.r);
    e.information = W.transpose() * W;
    e.widening = wideningOf(w, W, e.information, e.observability, prior.sigmas());
    recordSurprise(squaredRows(w), &e);
    if (k + 1 < kRounds) rejectContradictions(&e);
  }
  e.covariance = ParameterMatrix::Zero();
  for (const Direction& d : e.observability.directions) {
    if (d.observed) continue;  // keeps the prior's covariance
    const ParameterVector v = prior.sigmas().asDiagonal() * d.vector;
    e.covariance += v * v.transpose();
  }
  averageOver(&forms, prior, active, &e);
  for (NoiseComponent& c : e.noise) c.pattern = BlockTridiagonal();
  return e;
}

}  // namespace rf::calibration
