// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/se3.hpp"
#include "segmentation/image_terms.hpp"
#include "segmentation/joint_prior.hpp"
#include "segmentation/score_solver.hpp"

namespace rf {

/// Weights of the joint problem; sources in docs/ALGORITHM.md.
struct JointParams {
  double kappa = 10;           ///< pixels per independent measurement: residuals are correlated
  double lambda_r = 2;         ///< weight of S_R and S_T (paper, section V)
  double cauchy_factor = 0.5;  ///< c = factor * weighted mean |r| (StaticFusion)
  double cauchy_floor =
      0.3;  ///< of c, in sigma: a perfect fit must not sharpen the kernel for ever
  double outlier_margin =
      1.0;  ///< without an object prior: log-energy above the static mean at which
            ///< a cluster leaves the static world although no body explains it
  double step_tolerance = 2e-4;  ///< stop when no motion moves more than this (m, rad)

  template <class V>
  void visit(V& v) {
    v("kappa", kappa, 0.1, 1000.0, "px", "pixels per independent measurement");
    v("lambda_r", lambda_r, 1e-3, 100.0, "-", "weight of the score regularisers");
    v("cauchy_factor", cauchy_factor, 0.01, 10.0, "-", "Cauchy scale per mean absolute residual");
    v("cauchy_floor", cauchy_floor, 0.01, 10.0, "sigma", "smallest Cauchy scale");
    v("outlier_margin", outlier_margin, 0.0, 10.0, "-",
      "log energy above the static mean of an outlier cluster");
    v("step_tolerance", step_tolerance, 1e-9, 0.1, "m, rad",
      "smallest step worth another iteration");
  }
};

/// One pyramid level of the pair, with B's clusters on it. All referenced objects outlive the call.
struct JointLevel {
  const TermLevel* a = nullptr;
  const TermLevel* b = nullptr;
  const Image<std::uint8_t>* label = nullptr;  ///< on b's grid, kNoCluster = no depth
};

/// The unknowns of Eq. 1.
struct JointState {
  SE3 T_s;                   ///< C_B -> C_A of the static world
  SE3 T_d;                   ///< C_B -> C_A of the body
  std::vector<float> gamma;  ///< per cluster
  double c = 0;              ///< Cauchy scale of the last linearisation
  bool one_body = false;     ///< T_d == T_s, gamma == 1: only T_s is estimated
};

/// Score terms that stay fixed during one solve: graph, targets of S_T and their weights.
struct ScorePrior {
  std::vector<float> target;  ///< gamma~ per cluster
  std::vector<float> weight;  ///< unary weight per cluster, 1 = the paper's
};

/// Mean log energies per cluster over the pixels valid under both motions (algorithm B.4 form i).
struct ClusterEnergies {
  std::vector<double> static_energy, object_energy;
  std::vector<int> pixels;
};

/// What a solve leaves for the decision between hypotheses.
struct JointFit {
  JointState state;
  BodyTerms terms_s, terms_d;           ///< residuals at the final state (rows unset)
  Mat12 information = Mat12::Zero();    ///< of (delta_s, delta_d), image / kappa plus prior
  double inliers_s = 0, inliers_d = 0;  ///< gamma-weighted Cauchy-weighted pixel counts
  double rms_s = 0, rms_d = 0;          ///< of the whitened residuals, weighted alike
};

/// Alternates re-warping, exact score step and one coupled 12x12 Gauss-Newton step on (T_s, T_d)
/// (Eq. 1 with information-weighted priors). `fix_gamma` skips the score step.
JointFit solveJoint(const JointLevel& level, const JointState& start, const JointPrior& prior,
                    const ScorePrior& scores, const Adjacency& adjacency, const JointParams& params,
                    const ImageTermParams& terms, int iterations, bool fix_gamma = false);

/// Energies of a fit under a given Cauchy scale.
ClusterEnergies clusterEnergies(const JointLevel& level, const JointFit& fit, double c);

/// Mean over pixels of gamma l_s + (1 - gamma) l_d under a given Cauchy scale; the object's energy
/// is capped by the outlier energy when there is no object prior.
double imageEnergy(const JointLevel& level, const JointFit& fit, const JointPrior& prior,
                   const JointParams& params, double c);

/// Log energy that each cluster saves as a part of the body at the fit's motions, the body's energy
/// capped as above; 0 where a cluster has no pixels.
std::vector<double> bodyAdvantages(const JointLevel& level, const JointFit& fit,
                                   const JointPrior& prior, const JointParams& params);

/// Scores from the residuals at two given motions alone (for hypotheses that know motions, not
/// labels).
std::vector<float> scoresFromMotions(const JointLevel& level, const JointState& motions,
                                     const JointPrior& prior, const ScorePrior& scores,
                                     const Adjacency& adjacency, const JointParams& params,
                                     const ImageTermParams& terms);

}  // namespace rf
