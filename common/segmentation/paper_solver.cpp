// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/paper_solver.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "segmentation/score_solver.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

constexpr double kLeastSupport = 20;    // pixels below which a body has no data (guard a)
constexpr double kHysteresis = 0.9;     // of the prior switch (B.3)
constexpr float kLeastScale = 0.5e-3F;  // of c (B.2)
constexpr int kFrozenIterations = 2;    // last inner iterations that keep the prior switch

/// Weight per label of one body: gamma^power, or (1 - gamma)^power for the object.
LabelWeights bodyWeights(const std::vector<float>& gamma, bool object, int power) {
  LabelWeights weights{};
  for (std::size_t k = 0; k < gamma.size() && k < kNoCluster; ++k) {
    const float g = std::clamp(object ? 1.0F - gamma[k] : gamma[k], 0.0F, 1.0F);
    weights[k] = power == 2 ? g * g : g;
  }
  return weights;
}

/// Common robust scale c = factor * weighted mean |r| over both bodies (A.7, B.2).
float cauchyScale(const ClusterResiduals& r, const std::vector<float>& gamma,
                  const PaperConfig& config, ScoreRule rule) {
  double sum = 0, weight = 0;
  for (std::size_t k = 0; k < r.pixels.size(); ++k) {
    const double g = rule == ScoreRule::kJoint ? static_cast<double>(gamma[k]) : 1.0;
    sum += g * r.abs_s[k] + (1 - g) * r.abs_d[k];
    weight += r.pixels[k];
  }
  const double mean = weight > 0 ? sum / (2 * weight) : 0;
  return std::max(kLeastScale, static_cast<float>(config.cauchy_factor * mean));
}

/// One body within one outer iteration.
struct Body {
  PaperRows* rows = nullptr;
  SE3* T = nullptr;
  SE3 start;  ///< of the frame: bound of guard (c)
  PaperPrior prior;
  double lambda = 0;
  bool object = false;
  bool switched_on = false;
  bool rejected = false;
  PriorError error;
  Vec6 delta = Vec6::Zero();
  NormalSums sums;
};

void updateSwitch(Body& body, double n_hat) {
  const double distance = (body.error.e + body.error.J * body.delta).norm();
  body.switched_on = distance > (body.switched_on ? kHysteresis * n_hat : n_hat);
}

void stepMotion(Body& body, const Image<std::uint8_t>& label, const std::vector<float>& gamma,
                float c, const PaperConfig& config, bool frozen) {
  const LabelWeights weights = bodyWeights(gamma, body.object, config.gamma_power);
  body.sums = accumulate(*body.rows, label, weights, body.delta, c);
  if (body.prior && !frozen) updateSwitch(body, config.n_hat);
  body.delta = motionStep(body.sums, body.error, body.prior && body.switched_on ? body.lambda : 0);
}

/// T <- T exp(delta) unless that leaves the physical bounds (guard c).
void applyStep(Body& body, const PaperConfig& config) {
  const SE3 moved = *body.T * SE3::exp(body.delta);
  const Vec6 away = (body.start.inverse() * moved).log();
  const bool sane = moved.isFinite() && away.head<3>().norm() < config.max_step_m &&
                    away.tail<3>().norm() < config.max_step_rad;
  body.rejected = !sane;
  *body.T = sane ? moved : body.start;
  if (!sane) body.delta.setZero();
}

std::vector<float> jointScores(const ClusterResiduals& r, const std::vector<float>& target,
                               const Adjacency& adjacency, const PaperConfig& config) {
  const std::size_t n = target.size();
  std::vector<double> delta(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    if (r.pixels[k] > 0) delta[k] = (r.log_s[k] - r.log_d[k]) / r.pixels[k];
  }
  return solveScores(delta, target, std::vector<float>(n, 1.0F), adjacency, config.lambda_r);
}

/// Mean of max(-1, 1 - k_z |D_t|) per cluster and the share of pixels behind it (A.8).
struct DepthConsistency {
  double beta = -1;
  double share = 0.1;
};
DepthConsistency consistency(const ClusterResiduals& r, int size, std::size_t k) {
  constexpr double kDepthSlope = 1.5, kLeastShare = 0.1;
  DepthConsistency out;
  const double share = size > 0 ? r.pixels[k] / size : 0;
  if (share < kLeastShare) return out;
  out.share = std::min(1.0, share);
  out.beta = std::clamp(1.0 - kDepthSlope * r.depth_s[k] / r.pixels[k], -1.0, 2.0);
  return out;
}

std::vector<int> labelCounts(const Image<std::uint8_t>& label, std::size_t clusters) {
  std::vector<int> counts(256, 0);
  for (const std::uint8_t k : label) ++counts[k];
  counts.resize(clusters);
  return counts;
}

/// The alternation on one level.
class LevelSolver {
 public:
  LevelSolver(const PaperProblem& problem, const PaperConfig& config, std::size_t level,
              PaperWorkspace& workspace, Body& s, Body& d)
      : problem_(problem),
        config_(config),
        a_((*problem.a)[level]),
        b_((*problem.b)[level]),
        label_(problem.clusters->label[level]),
        clusters_(problem.clusters->centres.size()),
        two_(problem.rule == ScoreRule::kJoint),
        s_(s),
        d_(d) {
    s_.rows = &workspace.s[level];
    d_.rows = &workspace.d[level];
  }

  void run(std::vector<float>& gamma, bool coarsest) {
    for (int outer = 0; outer < config_.outer_iterations; ++outer) {
      linearise();
      const std::vector<float> target = temporalPrior();
      ClusterResiduals residuals = evaluate(kLeastScale);
      float c = cauchyScale(residuals, gamma, config_, problem_.rule);
      if (coarsest && problem_.rule == ScoreRule::kOutlier) startFromDepth(residuals, gamma);
      if (coarsest && outer == 0 && two_) gamma = target;
      alternate(target, c, gamma);
      const double moved = std::max(s_.delta.norm(), two_ ? d_.delta.norm() : 0.0);
      applyStep(s_, config_);
      if (two_) applyStep(d_, config_);
      if (moved < config_.outer_tolerance) break;
    }
  }

 private:
  void linearise() {
    for (Body* body : {&s_, &d_}) {
      if (body->object && !two_) continue;
      linearisePair(a_, b_, *body->T, config_, *body->rows);
      body->delta.setZero();
      if (body->prior) body->error = priorError(*body->T, *body->prior);
    }
    normalise(config_, *s_.rows, two_ ? d_.rows : nullptr);
  }

  ClusterResiduals evaluate(float c) const {
    return evaluateClusters(*s_.rows, s_.delta, two_ ? d_.rows : nullptr, d_.delta, label_,
                            clusters_, c);
  }

  std::vector<float> temporalPrior() const {
    std::vector<float> target(clusters_, 1.0F);
    if (!two_) return target;
    if (problem_.previous_scores != nullptr) {
      target = warpScores(b_, label_, clusters_, *d_.T, *problem_.previous_scores,
                          problem_.b->front().camera);
    }
    for (std::size_t k = 0; problem_.ceiling != nullptr && k < clusters_; ++k) {
      target[k] = std::min(target[k], (*problem_.ceiling)[k]);
    }
    return target;
  }

  void startFromDepth(const ClusterResiduals& residuals, std::vector<float>& gamma) const {
    const std::vector<int> sizes = labelCounts(label_, clusters_);
    for (std::size_t k = 0; k < clusters_; ++k) {
      gamma[k] = static_cast<float>(std::clamp(consistency(residuals, sizes[k], k).beta, 0.0, 1.0));
    }
  }

  void alternate(const std::vector<float>& target, float c, std::vector<float>& gamma) {
    for (int inner = 0; inner < config_.inner_iterations; ++inner) {
      const bool frozen = inner >= config_.inner_iterations - kFrozenIterations && inner > 0;
      const Vec6 before_s = s_.delta, before_d = d_.delta;
      stepMotion(s_, label_, gamma, c, config_, frozen);
      if (two_) stepMotion(d_, label_, gamma, c, config_, frozen);
      if (problem_.rule != ScoreRule::kNone || inner + 1 < config_.inner_iterations) {
        const ClusterResiduals residuals = evaluate(c);
        if (two_) gamma = jointScores(residuals, target, problem_.clusters->adjacency, config_);
        if (problem_.rule == ScoreRule::kOutlier) {
          gamma = outlierScores(residuals, labelCounts(label_, clusters_),
                                problem_.clusters->adjacency, c, config_, problem_.outlier_factor);
        }
        c = cauchyScale(residuals, gamma, config_, problem_.rule);
      }
      const double change = std::max((s_.delta - before_s).lpNorm<Eigen::Infinity>(),
                                     two_ ? (d_.delta - before_d).lpNorm<Eigen::Infinity>() : 0.0);
      if (change < config_.inner_tolerance) break;
    }
  }

  const PaperProblem& problem_;
  const PaperConfig& config_;
  const RgbdLevel& a_;
  const RgbdLevel& b_;
  const Image<std::uint8_t>& label_;
  std::size_t clusters_;
  bool two_;
  Body& s_;
  Body& d_;
};

}  // namespace

PriorError priorError(const SE3& T, const Vec6& xi) {
  const Vec6 log = T.log();
  return {log - xi, inverseRightJacobian(log)};
}

Vec6 motionStep(const NormalSums& sums, const PriorError& prior, double lambda) {
  Mat6 H = Mat6::Zero();
  Vec6 b = Vec6::Zero();
  if (sums.support >= kLeastSupport) {
    H = sums.H;
    b = sums.b;
  }
  if (lambda > 0) {
    H += 2 * lambda * prior.J.transpose() * prior.J;
    b -= 2 * lambda * prior.J.transpose() * prior.e;
  }
  const double trace = H.trace();
  if (!(trace > 0) || !std::isfinite(trace)) return Vec6::Zero();
  H += 1e-9 * trace / 6 * Mat6::Identity();
  const Vec6 step = H.ldlt().solve(b);
  return step.allFinite() ? step : Vec6::Zero();
}

std::vector<float> warpScores(const RgbdLevel& b, const Image<std::uint8_t>& label,
                              std::size_t clusters, const SE3& T_d,
                              const Image<float>& previous_scores, const Camera& score_camera) {
  std::vector<double> sum(clusters, 0.0), count(clusters, 0.0);
  const Eigen::Matrix3f R = T_d.R().cast<float>();
  const Eigen::Vector3f t = T_d.t.cast<float>();
  const Eigen::Vector3f across = R.col(0) / static_cast<float>(b.camera.fx);
  const auto fx = static_cast<float>(score_camera.fx), fy = static_cast<float>(score_camera.fy);
  const auto cx = static_cast<float>(score_camera.cx), cy = static_cast<float>(score_camera.cy);
  const auto columns = static_cast<float>(previous_scores.width());
  const auto rows = static_cast<float>(previous_scores.height());
  for (int v = 0; v < label.height(); ++v) {
    const Vec3 first = b.camera.backProject(0, v, 1.0);
    const Eigen::Vector3f ray = R * first.cast<float>();
    for (int u = 0; u < label.width(); ++u) {
      const std::uint8_t k = label(u, v);
      if (k >= clusters) continue;
      const Eigen::Vector3f p = b.depth(u, v) * (ray + static_cast<float>(u) * across) + t;
      if (!(p.z() > 0.05F)) continue;
      const float iz = 1.0F / p.z();
      const float ua = fx * p.x() * iz + cx + 0.5F, va = fy * p.y() * iz + cy + 0.5F;
      if (!(ua >= 0 && va >= 0 && ua < columns && va < rows)) continue;
      sum[k] += static_cast<double>(previous_scores(static_cast<int>(ua), static_cast<int>(va)));
      count[k] += 1;
    }
  }
  std::vector<float> out(clusters, 1.0F);
  for (std::size_t k = 0; k < clusters; ++k) {
    if (count[k] > 0) out[k] = static_cast<float>(sum[k] / count[k]);
  }
  return out;
}

std::vector<float> outlierScores(const ClusterResiduals& r, const std::vector<int>& sizes,
                                 const Adjacency& adjacency, float scale, const PaperConfig& config,
                                 double outlier_factor) {
  constexpr double kDepthWeight = 0.5, kSmooth = 0.49, kLeastMean = 1e-3;  // lambda_P, 4 lambda_R^2
  const auto n = static_cast<Eigen::Index>(r.pixels.size());
  const double mean = static_cast<double>(scale) / config.cauchy_factor;
  const auto penalty = [&](double x) {
    const double t = x / static_cast<double>(scale);
    return std::log1p(t * t);
  };
  const double limit = penalty(outlier_factor * std::max(kLeastMean, mean));
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd rhs(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const DepthConsistency depth = consistency(r, sizes[k], k);
    const bool seen = depth.share > 0.1;
    const double a = seen ? 2 * kDepthWeight * depth.share : 2 * depth.share;
    const double residual = r.abs_s[k] / (2 * (r.pixels[k] + 1));
    M(i, i) += a * a;
    rhs(i) = a * (a * depth.beta + (seen ? limit - penalty(residual) : 0.0));
    for (Eigen::Index j = 0; j < n; ++j) {
      if (!adjacency.joined(k, static_cast<std::size_t>(j))) continue;
      M(i, i) += kSmooth;
      M(i, j) -= kSmooth;
    }
  }
  const Eigen::VectorXd b = M.ldlt().solve(rhs);
  std::vector<float> out(r.pixels.size(), 1.0F);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::isfinite(b(i))) {
      out[static_cast<std::size_t>(i)] = static_cast<float>(std::clamp(b(i), 0.0, 1.0));
    }
  }
  return out;
}

PaperFit solvePair(const PaperProblem& problem, const PaperState& start, const PaperConfig& config,
                   int coarsest, int finest, PaperWorkspace& workspace) {
  const std::size_t levels = problem.b->size();
  workspace.s.resize(levels);
  workspace.d.resize(levels);
  PaperFit fit;
  fit.state = start;
  Body s, d;
  s.T = &fit.state.T_s;
  s.start = start.T_s;
  s.prior = problem.prior_s;
  s.lambda = config.lambda_s;
  d.T = &fit.state.T_d;
  d.start = start.T_d;
  d.prior = problem.prior_d;
  d.lambda = config.lambda_d;
  d.object = true;
  const bool two = problem.rule == ScoreRule::kJoint;
  for (int level = coarsest; level >= finest; --level) {
    LevelSolver solver(problem, config, static_cast<std::size_t>(level), workspace, s, d);
    solver.run(fit.state.gamma, level == coarsest);
  }
  const Image<std::uint8_t>& label = problem.clusters->label[static_cast<std::size_t>(finest)];
  fit.s = s.sums;
  fit.rejected_s = s.rejected;
  fit.fit_s = judgeFit(*s.rows, label, bodyWeights(fit.state.gamma, false, 1));
  if (two) {
    fit.d = d.sums;
    fit.rejected_d = d.rejected;
    fit.fit_d = judgeFit(*d.rows, label, bodyWeights(fit.state.gamma, true, 1));
  }
  return fit;
}

}  // namespace rf
