// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/whitened_solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <ceres/ceres.h>
#include <Eigen/Eigenvalues>

namespace rf::calibration {
namespace {

constexpr double kCauchyScale = 4.0;  ///< the norm of six unit normals is 2.4 on average
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, kParameters, Eigen::RowMajor>;

/// Residuals and derivatives of all rows at the point that Ceres is about to evaluate.
class RowCache : public ceres::EvaluationCallback {
 public:
  RowCache(const RowModel& model, const BlockFactor& noise, CalibrationValues reference,
           const ParameterVector& delta)
      : model_(model), noise_(noise), reference_(std::move(reference)), delta_(delta) {}

  void PrepareForEvaluation(bool with_jacobians, bool /*new_point*/) override {
    const CalibrationValues values = plus(reference_, delta_);
    Eigen::VectorXd r_raw;
    Eigen::MatrixXd J_raw;
    model_.evaluate(values, &r_raw, with_jacobians ? &J_raw : nullptr);
    r = noise_.whiten(r_raw);
    if (with_jacobians) J = noise_.whiten(J_raw) * plusJacobian(delta_);
  }

  Eigen::VectorXd r;
  RowMajor J;

 private:
  const RowModel& model_;
  const BlockFactor& noise_;
  CalibrationValues reference_;
  const ParameterVector& delta_;
};

/// Rows first .. first + count of the cache.
class CachedRows : public ceres::CostFunction {
 public:
  CachedRows(const RowCache& cache, Eigen::Index first, int count) : cache_(cache), first_(first) {
    set_num_residuals(count);
    mutable_parameter_block_sizes()->push_back(kParameters);
  }
  bool Evaluate(double const* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) =
        cache_.r.segment(first_, num_residuals());
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], num_residuals(), kParameters) =
          cache_.J.middleRows(first_, num_residuals());
    }
    return cache_.r.allFinite();
  }

 private:
  const RowCache& cache_;
  Eigen::Index first_;
};

/// Square root of the prior's precision times the difference to the prior.
class PriorRows : public ceres::CostFunction {
 public:
  PriorRows(const ParameterMatrix& information, const CalibrationPrior& prior,
            CalibrationValues reference)
      : prior_(prior.values), reference_(std::move(reference)) {
    const ParameterVector sigmas = prior.sigmas();
    const Eigen::SelfAdjointEigenSolver<ParameterMatrix> eigen(sigmas.asDiagonal() * information *
                                                               sigmas.asDiagonal());
    root_ = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
            eigen.eigenvectors().transpose() * sigmas.cwiseInverse().asDiagonal();
    set_num_residuals(kParameters);
    mutable_parameter_block_sizes()->push_back(kParameters);
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const ParameterVector delta = Eigen::Map<const ParameterVector>(parameters[0]);
    const CalibrationValues values = plus(reference_, delta);
    Eigen::Map<ParameterVector>(residuals, kParameters) = root_ * difference(values, prior_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<RowMajor>(jacobians[0], kParameters, kParameters) =
          root_ * differenceJacobian(values, prior_) * plusJacobian(delta);
    }
    return true;
  }

 private:
  CalibrationValues prior_;
  CalibrationValues reference_;
  ParameterMatrix root_;
};

/// A robust pass is a start only: its tolerance is coarse.
ceres::Solver::Options solverOptions(bool robust) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = robust ? 50 : 100;
  options.function_tolerance = robust ? 1e-7 : 1e-13;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

/// Ceres judges its own derivatives column by column: those of fixed parameters are left out.
void fixInactive(const ParameterMask& active, double* block, ceres::Problem* problem) {
  std::vector<int> fixed;
  for (int k = 0; k < kParameters; ++k) {
    if (!active[static_cast<std::size_t>(k)]) fixed.push_back(k);
  }
  if (fixed.empty()) return;
  problem->SetManifold(block, new ceres::SubsetManifold(kParameters, fixed));
}

CalibrationValues solve(const RowModel& model, const BlockFactor& noise, bool robust,
                        const CalibrationValues& start, const CalibrationPrior& prior,
                        const ParameterMatrix& prior_information, const ParameterMask& active,
                        bool* converged) {
  ParameterVector delta = ParameterVector::Zero();
  RowCache cache(model, noise, start, delta);
  ceres::Problem::Options options;
  options.evaluation_callback = &cache;
  ceres::Problem problem(options);
  const auto rows = static_cast<Eigen::Index>(model.rows());
  if (robust) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      problem.AddResidualBlock(new CachedRows(cache, 6 * i, 6), new ceres::CauchyLoss(kCauchyScale),
                               delta.data());
    }
  } else {
    problem.AddResidualBlock(new CachedRows(cache, 0, static_cast<int>(6 * rows)), nullptr,
                             delta.data());
  }
  problem.AddResidualBlock(new PriorRows(prior_information, prior, start), nullptr, delta.data());
  fixInactive(active, delta.data(), &problem);
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(robust), &problem, &summary);
  if (converged != nullptr) *converged = summary.termination_type == ceres::CONVERGENCE;
  return plus(start, delta);
}

}  // namespace

CalibrationValues solveRobust(const RowModel& model, const BlockFactor& row_noise,
                              const CalibrationValues& start, const CalibrationPrior& prior,
                              const ParameterMatrix& prior_information,
                              const ParameterMask& active) {
  return solve(model, row_noise, true, start, prior, prior_information, active, nullptr);
}

CalibrationValues solveWhitened(const RowModel& model, const BlockFactor& noise,
                                const CalibrationValues& start, const CalibrationPrior& prior,
                                const ParameterMatrix& prior_information,
                                const ParameterMask& active, bool* converged) {
  return solve(model, noise, false, start, prior, prior_information, active, converged);
}

}  // namespace rf::calibration
