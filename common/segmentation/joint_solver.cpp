// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/joint_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/parallel.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

constexpr std::size_t kPixelsPerChunk = 2400;  // fixed: never by thread count
constexpr double kMaxTranslationStep = 0.15;   // metres in one Gauss-Newton step
constexpr double kMaxRotationStep = 0.25;      // radians

int chunksOf(std::size_t pixels) {
  return static_cast<int>((pixels + kPixelsPerChunk - 1) / kPixelsPerChunk);
}

template <typename Body>
void forChunk(int chunk, std::size_t pixels, const Body& body) {
  const std::size_t begin = static_cast<std::size_t>(chunk) * kPixelsPerChunk;
  const std::size_t end = std::min(pixels, begin + kPixelsPerChunk);
  for (std::size_t i = begin; i < end; ++i) body(i);
}

/// gamma of every pixel; -1 where there is no cluster.
std::vector<float> pixelScores(const Image<std::uint8_t>& label, const std::vector<float>& gamma) {
  std::vector<float> table(256, -1.0F);
  for (std::size_t k = 0; k < gamma.size(); ++k) table[k] = std::clamp(gamma[k], 0.0F, 1.0F);
  table[kNoCluster] = -1.0F;
  std::vector<float> scores(label.size());
  for (std::size_t i = 0; i < label.size(); ++i) scores[i] = table[label[i]];
  return scores;
}

struct AbsoluteSum {
  double residual = 0, weight = 0;
  AbsoluteSum& operator+=(const AbsoluteSum& o) {
    residual += o.residual;
    weight += o.weight;
    return *this;
  }
};

/// c = factor * sum g (|r_I| + |r_D|) / (2 sum g) over both bodies.
double cauchyScale(const BodyTerms& s, const BodyTerms& d, const std::vector<float>& score,
                   bool one_body, const JointParams& params) {
  const std::size_t pixels = score.size();
  const auto sum = reduceChunks(chunksOf(pixels), AbsoluteSum{}, [&](int chunk, AbsoluteSum& out) {
    forChunk(chunk, pixels, [&](std::size_t i) {
      if (score[i] < 0) return;
      if (s.valid[i] != 0) {
        const double g = score[i];
        out.residual += g * (std::abs(s.r_intensity[i]) + std::abs(s.r_depth[i]));
        out.weight += 2 * g;
      }
      if (!one_body && d.valid[i] != 0) {
        const double g = 1.0 - score[i];
        out.residual += g * (std::abs(d.r_intensity[i]) + std::abs(d.r_depth[i]));
        out.weight += 2 * g;
      }
    });
  });
  const double mean = sum.weight > 0 ? sum.residual / sum.weight : 0.0;
  return std::max(params.cauchy_floor, params.cauchy_factor * mean);
}

/// Normal equations of one body: sums of g w a a' and g w a r over both residual kinds.
struct NormalSum {
  double h[21] = {};
  double b[6] = {};
  double weight = 0, square = 0;
  NormalSum& operator+=(const NormalSum& o) {
    for (int k = 0; k < 21; ++k) h[k] += o.h[k];
    for (int k = 0; k < 6; ++k) b[k] += o.b[k];
    weight += o.weight;
    square += o.square;
    return *this;
  }
};

/// The same sums in single precision. A row i of w a (a', r) at once: lanes below i mean nothing.
struct NormalAccumulator {
  using Lanes = Eigen::Array<float, 8, 1>;  ///< of one pixel: its six derivatives and its residual
  std::array<Lanes, 6> rows = zero();

  static std::array<Lanes, 6> zero() {
    std::array<Lanes, 6> out;
    out.fill(Lanes::Zero());
    return out;
  }
  void add(const Lanes& a, float w) {
    for (int i = 0; i < 6; ++i) rows[i] += w * a[i] * a;
  }
  void flush(NormalSum& out) {
    int k = 0;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) out.h[k++] += static_cast<double>(rows[i][j]);
      out.b[i] += static_cast<double>(rows[i][6]);
    }
    rows = zero();
  }
};

NormalSum normalEquations(const BodyTerms& terms, const std::vector<float>& score, bool object,
                          double c) {
  const std::size_t pixels = score.size();
  const auto inv_c2 = static_cast<float>(1.0 / (c * c));
  return reduceChunks(chunksOf(pixels), NormalSum{}, [&](int chunk, NormalSum& out) {
    NormalAccumulator sum;
    int pending = 0;
    forChunk(chunk, pixels, [&](std::size_t i) {
      if (terms.valid[i] == 0 || score[i] < 0) return;
      const float g = object ? 1.0F - score[i] : score[i];
      if (!(g > 1e-3F)) return;
      const auto addRow = [&](const std::vector<float>* rows, float r) {
        const float w = g / (1.0F + r * r * inv_c2);
        NormalAccumulator::Lanes a;
        a << rows[0][i], rows[1][i], rows[2][i], rows[3][i], rows[4][i], rows[5][i], r, 0.0F;
        sum.add(a, w);
        out.weight += 0.5 * static_cast<double>(w);
        out.square += 0.5 * static_cast<double>(w * r * r);
      };
      addRow(terms.row_intensity, terms.r_intensity[i]);
      addRow(terms.row_depth, terms.r_depth[i]);
      if (++pending == 256) {  // single precision only over short runs
        sum.flush(out);
        pending = 0;
      }
    });
    sum.flush(out);
  });
}

void place(const NormalSum& sum, double scale, int at, Mat12& H, Vec12& b) {
  int k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j, ++k) {
      H(at + i, at + j) += scale * sum.h[k];
      if (i != j) H(at + j, at + i) += scale * sum.h[k];
    }
    b(at + i) -= scale * sum.b[i];
  }
}

/// Adds both prior terms, linearised at the current motions.
void placePrior(const JointPrior& prior, const SE3& T_s, const SE3& T_d, Mat12& H, Vec12& b) {
  const auto add = [&](const Vec6& e, const Mat6& information,
                       const Eigen::Matrix<double, 6, 12>& J) {
    const double chi = std::sqrt(std::max(0.0, e.dot(information * e)));
    const Mat6 weighted = huberWeight(chi) * information;
    H += J.transpose() * weighted * J;
    b -= J.transpose() * weighted * e;
  };
  Eigen::Matrix<double, 6, 12> J = Eigen::Matrix<double, 6, 12>::Zero();
  const Vec6 e_s = prior.staticError(T_s);
  J.leftCols<6>() = inverseRightJacobian(e_s);
  add(e_s, prior.information_s, J);
  if (prior.object == JointPrior::Object::kNone) return;
  const Vec6 e_d = prior.objectError(T_s, T_d);
  J.setZero();
  J.rightCols<6>() = inverseRightJacobian(e_d);
  if (prior.object == JointPrior::Object::kRelative) {
    J.leftCols<6>() = -inverseRightJacobian(e_d) * SE3::exp(-e_d).adjoint();
  }
  add(e_d, prior.information_d, J);
}

/// Shortens a step that no camera at video rate can make; keeps the direction.
Vec6 boundedStep(Vec6 step) {
  const double scale = std::max(step.head<3>().norm() / kMaxTranslationStep,
                                step.tail<3>().norm() / kMaxRotationStep);
  return scale > 1.0 ? Vec6(step / scale) : step;
}

/// What is left static below this share of the pixels is what fits best by chance: no measure of
/// what an explained cluster costs. Capped by it a view that is all body looked cheap.
constexpr double kLeastExplained = 0.1;

/// Without an object prior a cluster may leave the static world although no body explains it: its
/// energy as a part of the body is capped above what an explained cluster costs.
void capObjectEnergies(const JointPrior& prior, const JointParams& params,
                       const std::vector<float>& gamma, ClusterEnergies& energies) {
  if (!prior.outlier_class) return;
  double sum = 0;
  double weight = 0;
  double pixels = 0;
  for (std::size_t k = 0; k < energies.pixels.size(); ++k) {
    const double w = energies.pixels[k] * (gamma.empty() ? 1.0 : static_cast<double>(gamma[k]));
    sum += w * energies.static_energy[k];
    weight += w;
    pixels += energies.pixels[k];
  }
  if (!(weight > kLeastExplained * pixels)) return;
  const double cap = sum / weight + params.outlier_margin;
  for (double& e : energies.object_energy) e = std::min(e, cap);
}

std::vector<double> differences(const ClusterEnergies& energies) {
  std::vector<double> delta(energies.pixels.size(), 0.0);
  for (std::size_t k = 0; k < delta.size(); ++k) {
    if (energies.pixels[k] > 0) delta[k] = energies.static_energy[k] - energies.object_energy[k];
  }
  return delta;
}

std::vector<float> scoreStep(ClusterEnergies energies, const JointPrior& prior,
                             const ScorePrior& scores, const Adjacency& adjacency,
                             const JointParams& params, const std::vector<float>& gamma) {
  capObjectEnergies(prior, params, gamma, energies);
  return solveScores(differences(energies), scores.target, scores.weight, adjacency,
                     params.lambda_r);
}

}  // namespace

ClusterEnergies clusterEnergies(const JointLevel& level, const JointFit& fit, double c) {
  const std::size_t count = fit.state.gamma.size();
  ClusterEnergies out{std::vector<double>(count), std::vector<double>(count),
                      std::vector<int>(count)};
  const auto inv_c2 = static_cast<float>(1.0 / (c * c));
  const bool one = fit.state.one_body;
  const auto energy = [inv_c2](const BodyTerms& t, std::size_t i) {
    return std::log((1.0F + t.r_intensity[i] * t.r_intensity[i] * inv_c2) *
                    (1.0F + t.r_depth[i] * t.r_depth[i] * inv_c2));
  };
  for (std::size_t i = 0; i < level.label->size(); ++i) {
    const std::uint8_t k = (*level.label)[i];
    if (k >= count || fit.terms_s.valid[i] == 0 || (!one && fit.terms_d.valid[i] == 0)) continue;
    const float e_s = energy(fit.terms_s, i);
    out.static_energy[k] += static_cast<double>(e_s);
    out.object_energy[k] +=
        one ? static_cast<double>(e_s) : static_cast<double>(energy(fit.terms_d, i));
    ++out.pixels[k];
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (out.pixels[k] == 0) continue;
    out.static_energy[k] /= out.pixels[k];
    out.object_energy[k] /= out.pixels[k];
  }
  return out;
}

double imageEnergy(const JointLevel& level, const JointFit& fit, const JointPrior& prior,
                   const JointParams& params, double c) {
  ClusterEnergies e = clusterEnergies(level, fit, c);
  capObjectEnergies(prior, params, fit.state.gamma, e);
  double total = 0;
  double pixels = 0;
  for (std::size_t k = 0; k < e.pixels.size(); ++k) {
    const double g = static_cast<double>(fit.state.gamma[k]);
    total += e.pixels[k] * (g * e.static_energy[k] + (1 - g) * e.object_energy[k]);
    pixels += e.pixels[k];
  }
  return pixels > 0 ? total / pixels : 0;
}

std::vector<double> bodyAdvantages(const JointLevel& level, const JointFit& fit,
                                   const JointPrior& prior, const JointParams& params) {
  ClusterEnergies e = clusterEnergies(level, fit, fit.state.c);
  capObjectEnergies(prior, params, fit.state.gamma, e);
  return differences(e);
}

std::vector<float> scoresFromMotions(const JointLevel& level, const JointState& motions,
                                     const JointPrior& prior, const ScorePrior& scores,
                                     const Adjacency& adjacency, const JointParams& params,
                                     const ImageTermParams& terms) {
  JointFit fit;
  fit.state = motions;
  fit.state.one_body = false;
  fit.state.gamma.assign(scores.target.size(), 0.5F);
  linearise(*level.a, *level.b, motions.T_s, terms, false, fit.terms_s);
  linearise(*level.a, *level.b, motions.T_d, terms, false, fit.terms_d);
  // Every pixel is explained by the better of the two: the scale of what remains.
  const std::size_t pixels = level.label->size();
  double residual = 0;
  double weight = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (fit.terms_s.valid[i] == 0 || fit.terms_d.valid[i] == 0) continue;
    residual += static_cast<double>(
        std::min(std::abs(fit.terms_s.r_intensity[i]) + std::abs(fit.terms_s.r_depth[i]),
                 std::abs(fit.terms_d.r_intensity[i]) + std::abs(fit.terms_d.r_depth[i])));
    weight += 2;
  }
  const double c =
      std::max(params.cauchy_floor, weight > 0 ? params.cauchy_factor * residual / weight : 0.0);
  return scoreStep(clusterEnergies(level, fit, c), prior, scores, adjacency, params, {});
}

JointFit solveJoint(const JointLevel& level, const JointState& start, const JointPrior& prior,
                    const ScorePrior& scores, const Adjacency& adjacency, const JointParams& params,
                    const ImageTermParams& terms, int iterations, bool fix_gamma) {
  JointFit fit;
  fit.state = start;
  JointState& state = fit.state;
  if (state.one_body) state.gamma.assign(scores.target.size(), 1.0F);
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    const bool last = iteration == iterations;
    linearise(*level.a, *level.b, state.T_s, terms, true, fit.terms_s);
    if (!state.one_body) linearise(*level.a, *level.b, state.T_d, terms, true, fit.terms_d);
    std::vector<float> score = pixelScores(*level.label, state.gamma);
    state.c = cauchyScale(fit.terms_s, fit.terms_d, score, state.one_body, params);
    if (!fix_gamma && !state.one_body) {
      state.gamma = scoreStep(clusterEnergies(level, fit, state.c), prior, scores, adjacency,
                              params, state.gamma);
      score = pixelScores(*level.label, state.gamma);
      state.c = cauchyScale(fit.terms_s, fit.terms_d, score, false, params);
    }
    Mat12 H = Mat12::Zero();
    Vec12 b = Vec12::Zero();
    const double scale = 1.0 / (params.kappa * state.c * state.c);
    const NormalSum s = normalEquations(fit.terms_s, score, false, state.c);
    place(s, scale, 0, H, b);
    fit.inliers_s = s.weight;
    fit.rms_s = s.weight > 0 ? std::sqrt(s.square / s.weight) : 0;
    if (!state.one_body) {
      const NormalSum d = normalEquations(fit.terms_d, score, true, state.c);
      place(d, scale, 6, H, b);
      fit.inliers_d = d.weight;
      fit.rms_d = d.weight > 0 ? std::sqrt(d.square / d.weight) : 0;
    }
    JointPrior applied = prior;
    if (state.one_body) applied.object = JointPrior::Object::kNone;
    placePrior(applied, state.T_s, state.T_d, H, b);
    H.diagonal().array() += 1e-9 * H.trace() / 12 + 1e-9;  // a body without data stays where it is
    fit.information = H;
    if (last) break;
    const Vec12 step = H.ldlt().solve(b);
    if (!step.allFinite()) break;
    const Vec6 step_s = boundedStep(step.head<6>());
    state.T_s = state.T_s * SE3::exp(step_s);
    if (state.one_body) {
      state.T_d = state.T_s;
    } else {
      state.T_d = state.T_d * SE3::exp(boundedStep(step.tail<6>()));
    }
    const double moved = std::max(step_s.norm(), state.one_body ? 0.0 : step.tail<6>().norm());
    if (moved < params.step_tolerance && iteration + 1 < iterations) iteration = iterations - 1;
  }
  return fit;
}

}  // namespace rf
