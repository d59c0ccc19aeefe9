// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/paper_segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>

#include "segmentation/clusters.hpp"
#include "segmentation/paper_solver.hpp"
#include "segmentation/score_images.hpp"
#include "values/stage_clock.hpp"

namespace rf {
namespace {

constexpr int kSeedLevel = 2;            // where the outlier rule looks for a body without a prior
constexpr double kPixelsPerSample = 10;  // residuals of neighbouring pixels are correlated
constexpr double kWorstPrior = 6;        // Mahalanobis distance from a prior that is not "tracked"
constexpr double kWorstFit = 3;          // residuals this many sigma large are not "tracked"

/// Priors of one frame pair as motions, where they are usable.
struct Priors {
  std::optional<SE3> s, d;
  Mat6 cov_s = Mat6::Identity(), cov_d = Mat6::Identity();
};

/// What the next frame needs of this one.
struct Previous {
  std::int64_t utime = 0;
  std::vector<RgbdLevel> pyramid;
  Image<float> scores;  ///< Gamma_A
  SE3 T_s;              ///< last motion, for constant velocity
  SE3 T_CO;
  bool usable = false;
};

/// Covariance of a motion from its last normal equations; the prior's where the image says nothing.
Mat6 covarianceOf(const NormalSums& sums, const Mat6& prior_covariance) {
  if (!(sums.weight > 0) || !(sums.H.trace() > 0)) return prior_covariance;
  const double variance = sums.squares / sums.weight;
  const Mat6 H = sums.H + 1e-9 * sums.H.trace() / 6 * Mat6::Identity();
  const Mat6 inverse = H.ldlt().solve(Mat6::Identity());
  const Mat6 covariance = kPixelsPerSample * variance * 0.5 * (inverse + inverse.transpose());
  return covariance.allFinite() ? covariance : prior_covariance;
}

template <typename T, typename Convert>
Image<T> perPixel(const Image<std::uint8_t>& label, const std::vector<float>& gamma, T none,
                  const Convert& convert) {
  Image<T> out(label.width(), label.height(), none);
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] < gamma.size()) out[i] = convert(gamma[label[i]]);
  }
  return out;
}

double mahalanobis(const Vec6& e, const Mat6& covariance) {
  const Mat6 regular = covariance + 1e-12 * Mat6::Identity();
  const double squared = e.dot(regular.ldlt().solve(e));
  return squared >= 0 ? std::sqrt(squared) : std::numeric_limits<double>::infinity();
}

/// Image and prior contradict each other: in one frame, or by a little in one direction for long (a
/// world locked onto the object does). Drift of priors is correlated in translation, white in
/// rotation, so the mean narrows the latter alone.
class Consistency {
 public:
  void add(const SE3& prior, const Mat6& covariance, const SE3& estimate) {
    const Vec6 e = (prior.inverse() * estimate).log();
    mean_ += kShare * (e - mean_);
    Vec6 narrowed = Vec6::Ones();
    narrowed.tail<3>().setConstant(std::sqrt(kShare));
    contradicts_ = !(mahalanobis(e, covariance) < kWorstPrior) ||
                   !(mahalanobis(mean_, narrowed.asDiagonal() * covariance *
                                            narrowed.asDiagonal()) < kWorstMean);
  }
  bool contradicts() const { return contradicts_; }

 private:
  static constexpr double kShare = 0.1;  // of the newest frame: a mean over some ten frames
  static constexpr double kWorstPrior = 6, kWorstMean = 3;  // Mahalanobis distances
  Vec6 mean_ = Vec6::Zero();
  bool contradicts_ = false;
};

ScoreRule ruleOf(const std::string& mode) {
  if (mode == "rigidfusion-paper") return ScoreRule::kJoint;
  if (mode == "static" || mode == "static-prior") return ScoreRule::kOutlier;
  if (mode == "vo") return ScoreRule::kNone;
  throw std::invalid_argument("segmentation.mode = " + mode +
                              ": must be rigidfusion-paper, static, static-prior or vo here");
}

}  // namespace

struct PaperSegmenter::Impl {
  Impl(const SegmentationConfig& segmentation_config, const Camera& input_camera)
      : config(segmentation_config),
        paper(segmentation_config.paper),
        camera(input_camera),
        preparer(segmentation_config, input_camera, {paper.levels, paper.clusters, false}),
        rule(ruleOf(config.mode)),
        uses_prior(config.mode == "rigidfusion-paper" || config.mode == "static-prior") {}

  SegmentationConfig config;
  PaperConfig paper;
  Camera camera;
  FramePreparer preparer;
  ScoreRule rule;
  bool uses_prior;
  PaperWorkspace workspace;
  std::optional<Previous> last;
  bool object_prior_seen = false;
  std::int64_t pairs = 0;
  Consistency camera_consistency, object_consistency;

  SegmentationResult process(PreparedFrame frame, const MotionPrior& prior);
  SE3 firstObjectPose(const MotionPrior& prior) const;
  Priors usablePriors(const MotionPrior& prior) const;
  void estimate(const Clusters& clusters, const Priors& priors, Previous& now,
                SegmentationResult& out);
  PaperFit solveOneBody(PaperProblem problem, const SE3& start);
  PaperFit solveTwoBodies(PaperProblem problem, const Priors& priors, const SE3& start,
                          std::string& hypothesis);
  Health judge(const BodyFit& fit, bool rejected, bool has_prior, bool prior_expected,
               const Consistency& consistency) const;
  void coast(const Priors& priors, Previous& now, SegmentationResult& out) const;
};

SE3 PaperSegmenter::Impl::firstObjectPose(const MotionPrior& prior) const {
  if (prior.object == PriorState::kMissing || !prior.T_XOb.isFinite()) return {};
  if (prior.object_kind == ObjectPriorKind::kCameraFrame) return prior.T_XOb;
  if (prior.object_kind != ObjectPriorKind::kWorldFrame) return {};
  // Both sources as given, before any drift.
  const bool placed = prior.camera != PriorState::kMissing && prior.T_WCb.isFinite();
  return placed ? prior.T_WCb.inverse() * prior.T_XOb : prior.T_XOb;
}

/// xi~_s from the camera prior; xi~_d from T_CO at both ends, or through the object's own increment
/// and T_CO by our bookkeeping, so that absolute poses of two drifting sources are never composed.
Priors PaperSegmenter::Impl::usablePriors(const MotionPrior& prior) const {
  Priors out;
  if (!uses_prior) return out;
  if (prior.camera != PriorState::kMissing && prior.T_CaCb.isFinite()) {
    out.s = prior.T_CaCb;
    out.cov_s = prior.camera_cov;
  }
  const bool object =
      prior.object != PriorState::kMissing && prior.T_XOa.isFinite() && prior.T_XOb.isFinite();
  if (!object || rule != ScoreRule::kJoint) return out;
  out.cov_d = prior.object_cov;
  if (prior.object_kind == ObjectPriorKind::kCameraFrame) {
    out.d = prior.T_XOa * prior.T_XOb.inverse();
  } else if (prior.object_kind == ObjectPriorKind::kWorldFrame) {
    const SE3 increment = prior.T_XOa.inverse() * prior.T_XOb;
    const SE3 T_s = out.s.value_or(last->T_s);
    out.d = last->T_CO * increment.inverse() * last->T_CO.inverse() * T_s;
  }
  return out;
}

PaperFit PaperSegmenter::Impl::solveOneBody(PaperProblem problem, const SE3& start) {
  problem.prior_d.reset();
  const int coarsest = static_cast<int>(problem.b->size()) - 1;
  PaperState state{start, start, std::vector<float>(problem.clusters->centres.size(), 1.0F)};
  PaperFit fit = solvePair(problem, state, paper, coarsest, 0, workspace);
  fit.state.T_d = fit.state.T_s;
  return fit;
}

PaperFit PaperSegmenter::Impl::solveTwoBodies(PaperProblem problem, const Priors& priors,
                                              const SE3& start, std::string& hypothesis) {
  const int coarsest = static_cast<int>(problem.b->size()) - 1;
  const std::size_t clusters = problem.clusters->centres.size();
  PaperState state{start, priors.d.value_or(start), std::vector<float>(clusters, 1.0F)};
  int first = coarsest;
  std::vector<float> seed;
  if (!priors.d) {
    // No object prior: what StaticFusion's rule calls an outlier seeds the mask, and so xi_d.
    const int seed_level = std::min(kSeedLevel, coarsest);
    PaperProblem outliers = problem;
    outliers.rule = ScoreRule::kOutlier;
    const PaperFit seeding = solvePair(outliers, state, paper, coarsest, seed_level, workspace);
    seed = seeding.state.gamma;
    state.T_s = state.T_d = seeding.state.T_s;
    problem.ceiling = &seed;
    first = seed_level;
    hypothesis = "seeded";
  }
  PaperFit fit = solvePair(problem, state, paper, first, 0, workspace);
  const Image<std::uint8_t>& label = problem.clusters->label[0];
  if (1.0 - dynamicShare(label, fit.state.gamma) >= paper.least_static_share) return fit;
  // All dynamic is self-consistent and for ever (B.5): start the frame again from all static.
  hypothesis = "restart";
  problem.previous_scores = nullptr;
  problem.ceiling = nullptr;
  fit = solvePair(problem, state, paper, coarsest, 0, workspace);
  if (1.0 - dynamicShare(label, fit.state.gamma) < paper.least_static_share) {
    hypothesis = "collapsed";
  }
  return fit;
}

Health PaperSegmenter::Impl::judge(const BodyFit& fit, bool rejected, bool has_prior,
                                   bool prior_expected, const Consistency& consistency) const {
  const Camera working = camera.reduced(config.reduction);
  const double pixels = static_cast<double>(working.width) * working.height;
  if (rejected || fit.inliers < config.lost_inlier_share * pixels) {
    return has_prior ? Health::kPriorOnly : Health::kLost;
  }
  const bool weak = fit.inliers < config.degraded_inlier_share * pixels || fit.rms > kWorstFit;
  const bool alone = prior_expected && !has_prior;
  return weak || alone || (has_prior && consistency.contradicts()) ? Health::kDegraded
                                                                   : Health::kTracked;
}

void PaperSegmenter::Impl::coast(const Priors& priors, Previous& now,
                                 SegmentationResult& out) const {
  out.camera.T_AB = priors.s.value_or(last->T_s);
  out.camera.covariance = priors.cov_s;
  out.camera.health = priors.s ? Health::kPriorOnly : Health::kLost;
  out.object = out.camera;
  out.object.T_AB = priors.d.value_or(out.camera.T_AB);
  out.object.health = priors.d ? Health::kPriorOnly : Health::kLost;
  out.hypothesis = "no-image";
  now.T_CO = out.object.T_AB.inverse() * last->T_CO;
}

void PaperSegmenter::Impl::estimate(const Clusters& clusters, const Priors& priors, Previous& now,
                                    SegmentationResult& out) {
  StageClock clock;
  PaperProblem problem;
  problem.a = &last->pyramid;
  problem.b = &now.pyramid;
  problem.clusters = &clusters;
  problem.rule = rule;
  problem.previous_scores = &last->scores;
  problem.outlier_factor = pairs == 0 ? 1.0 + 0.1 * (paper.outlier_factor - 1.0)  // 1.05 of 1.5
                                      : paper.outlier_factor;
  if (priors.s) problem.prior_s = priors.s->log();
  if (priors.d) problem.prior_d = priors.d->log();
  const SE3 start = priors.s.value_or(last->T_s);
  // The gate d^: priors that hardly differ mean that nothing moves (paper section IV-C).
  const bool gated = rule == ScoreRule::kJoint && problem.prior_s && problem.prior_d &&
                     (*problem.prior_s - *problem.prior_d).norm() < paper.d_hat;
  PaperFit fit;
  if (rule == ScoreRule::kJoint && !gated) {
    out.hypothesis = "joint";
    fit = solveTwoBodies(problem, priors, start, out.hypothesis);
  } else {
    if (gated) problem.rule = ScoreRule::kNone;
    out.hypothesis = gated ? "gated" : config.mode;
    fit = solveOneBody(problem, start);
  }
  clock.lap("solve", out.stage_ms);

  const PaperState& state = fit.state;
  now.scores = perPixel<float>(clusters.label[0], state.gamma, 1.0F, [](float g) { return g; });
  const bool split =
      std::any_of(state.gamma.begin(), state.gamma.end(), [](float g) { return g < 0.5F; });
  if (split) out.gamma = state.gamma;
  out.object_moving = split && rule == ScoreRule::kJoint;
  out.camera.T_AB = state.T_s;
  out.camera.covariance = covarianceOf(fit.s, priors.cov_s);
  out.camera.inliers = fit.fit_s.inliers;
  out.camera.rms_residual = fit.fit_s.rms;
  if (priors.s) camera_consistency.add(*priors.s, priors.cov_s, state.T_s);
  out.camera.health =
      judge(fit.fit_s, fit.rejected_s, priors.s.has_value(), uses_prior, camera_consistency);
  if (out.hypothesis == "collapsed") {
    out.camera.health = priors.s ? Health::kPriorOnly : Health::kLost;
  }
  out.object = out.camera;
  if (out.object_moving) {
    out.object.T_AB = state.T_d;
    out.object.covariance = covarianceOf(fit.d, priors.cov_d);
    out.object.inliers = fit.fit_d.inliers;
    out.object.rms_residual = fit.fit_d.rms;
    if (priors.d) object_consistency.add(*priors.d, priors.cov_d, state.T_d);
    out.object.health = judge(fit.fit_d, fit.rejected_d, priors.d.has_value(), object_prior_seen,
                              object_consistency);
  }
  now.T_CO = out.object.T_AB.inverse() * last->T_CO;
  out.score = perPixel<std::uint8_t>(out.label, out.gamma, 255, [](float g) {
    return static_cast<std::uint8_t>(std::floor(255.0F * g + 0.5F));
  });
  out.dynamic_share = dynamicShare(out.label, out.gamma);
}

SegmentationResult PaperSegmenter::Impl::process(PreparedFrame frame, const MotionPrior& prior) {
  SegmentationResult out;
  out.stage_ms = std::move(frame.stage_ms);
  Previous now;
  now.utime = frame.utime;
  now.usable = frame.usable;
  now.pyramid = std::move(frame.pyramid);
  const Clusters& clusters = frame.clusters;

  out.utime = frame.utime;
  out.seq = frame.seq;
  out.reduction = config.reduction;
  out.label = clusters.label[0];
  out.gamma.assign(clusters.centres.size(), 1.0F);
  out.score = Image<std::uint8_t>(out.label.width(), out.label.height(), 255);
  now.scores = Image<float>(out.label.width(), out.label.height(), 1.0F);
  object_prior_seen |= prior.object != PriorState::kMissing && rule == ScoreRule::kJoint;
  if (!last) {
    out.first = true;
    out.utime_a = frame.utime;
    out.hypothesis = "first";
    out.camera.health = out.object.health = now.usable ? Health::kTracked : Health::kLost;
    now.T_CO = firstObjectPose(prior);
  } else {
    out.utime_a = last->utime;
    const Priors priors = usablePriors(prior);
    if (now.usable && last->usable) {
      estimate(clusters, priors, now, out);
      ++pairs;
    } else {
      coast(priors, now, out);
    }
    now.T_s = out.camera.T_AB;
  }
  out.has_prior_T_WC = prior.camera != PriorState::kMissing;
  if (out.has_prior_T_WC) out.prior_T_WC = prior.T_WCb;
  out.has_T_CO = object_prior_seen;
  if (out.has_T_CO) out.T_CO = now.T_CO;
  last = std::move(now);
  return out;
}

PaperSegmenter::PaperSegmenter(const SegmentationConfig& config, const Camera& camera)
    : impl_(std::make_unique<Impl>(config, camera)) {}
PaperSegmenter::~PaperSegmenter() = default;
PaperSegmenter::PaperSegmenter(PaperSegmenter&&) noexcept = default;

PreparedFrame PaperSegmenter::prepare(const RgbdFrame& frame) const {
  return impl_->preparer.prepare(frame);
}

SegmentationResult PaperSegmenter::process(PreparedFrame frame, const MotionPrior& prior,
                                           const ModelState* /*feedback*/) {
  return impl_->process(std::move(frame), prior);
}

void PaperSegmenter::reset() { impl_ = std::make_unique<Impl>(impl_->config, impl_->camera); }

}  // namespace rf
