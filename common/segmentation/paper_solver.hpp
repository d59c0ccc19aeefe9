// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "segmentation/clusters.hpp"
#include "segmentation/paper_config.hpp"
#include "segmentation/paper_rows.hpp"

namespace rf {

/// How the scores follow from the residuals: the only thing that differs between the modes.
enum class ScoreRule {
  kNone,     ///< one robust body, gamma stays 1 (vo)
  kOutlier,  ///< one body, the rest are outliers: StaticFusion's rule (A.8)
  kJoint,    ///< two bodies, the box-constrained QP of the paper (B.4)
};

/// lambda |log T - xi|^2 of Eq. 1 for one body; absent = lambda 0.
using PaperPrior = std::optional<Vec6>;

/// One frame pair. Everything referenced outlives the call.
struct PaperProblem {
  const std::vector<RgbdLevel>* a = nullptr;  ///< pyramid of the previous frame, [0] finest
  const std::vector<RgbdLevel>* b = nullptr;  ///< of the current frame
  const Clusters* clusters = nullptr;         ///< of b
  ScoreRule rule = ScoreRule::kJoint;
  PaperPrior prior_s, prior_d;
  /// Gamma_A on a's finest level, for gamma~ (S_T); kJoint only.
  const Image<float>* previous_scores = nullptr;
  /// Upper bounds of gamma~ (clusters the outlier rule calls dynamic, when there is no object
  /// prior).
  const std::vector<float>* ceiling = nullptr;
  double outlier_factor = 1.5;  ///< k_b
};

/// The unknowns of Eq. 1.
struct PaperState {
  SE3 T_s, T_d;              ///< C_B -> C_A
  std::vector<float> gamma;  ///< per cluster, 0..1
};

/// State at the end with what is needed to judge it.
struct PaperFit {
  PaperState state;
  NormalSums s, d;       ///< of the last Gauss-Newton step
  BodyFit fit_s, fit_d;  ///< against the sensor model
  bool rejected_s = false,
       rejected_d = false;  ///< a step broke the bounds: the motion is its start
};

/// Planes of every level, kept from frame to frame to spare their allocation.
struct PaperWorkspace {
  std::vector<PaperRows> s, d;
};

/// Error of a motion from its prior and the linearisation of it: log(T exp(d)) - xi ~ e + J d.
struct PriorError {
  Vec6 e = Vec6::Zero();
  Mat6 J = Mat6::Identity();
};
PriorError priorError(const SE3& T, const Vec6& xi);

/// Minimiser d of 1/2 d'H d - b'd + lambda |e + J d|^2 with a trace of Tikhonov; zero when neither
/// the image (b.weight) nor the prior says anything.
Vec6 motionStep(const NormalSums& sums, const PriorError& prior, double lambda);

/// gamma~ per cluster (paper S_T): mean of the previous scores where T_d puts the cluster's pixels
/// in A; 1 where all of them leave the image.
std::vector<float> warpScores(const RgbdLevel& b, const Image<std::uint8_t>& label,
                              std::size_t clusters, const SE3& T_d,
                              const Image<float>& previous_scores, const Camera& score_camera);

/// StaticFusion's segmentation step (A.8), clamped to [0, 1]. `scale` is the Cauchy scale c.
std::vector<float> outlierScores(const ClusterResiduals& residuals, const std::vector<int>& sizes,
                                 const Adjacency& adjacency, float scale, const PaperConfig& config,
                                 double outlier_factor);

/// Coarse-to-fine alternation from level `coarsest` to level `finest` (paper section IV-C): both
/// motions by IRLS with the adaptive prior weights, scores by the rule. Deterministic for every
/// thread count; finite for any input.
PaperFit solvePair(const PaperProblem& problem, const PaperState& start, const PaperConfig& config,
                   int coarsest, int finest, PaperWorkspace& workspace);

}  // namespace rf
