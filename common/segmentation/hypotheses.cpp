// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/hypotheses.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

struct Candidate {
  std::string name;
  JointFit fit;
  bool continued = false;
  double charge = 0;  ///< beside what every reading pays
};

/// Builds and solves the readings of one frame; each method is one of them.
class Readings {
 public:
  Readings(const DecisionInput& input, const JointParams& params, const DecisionParams& decision,
           const ImageTermParams& terms)
      : in_(input), params_(params), decision_(decision), terms_(terms) {
    const std::size_t clusters = in_.warped.target.size();
    weak_.target.assign(clusters, in_.window_prior.outlier_class ? 1.0F : 0.5F);
    weak_.weight.assign(clusters, static_cast<float>(decision.weak_pull));
  }

  Candidate continued() const {
    return {"continue", solve(in_.continued, in_.step_prior, in_.warped), true};
  }

  Candidate oneBody() const {
    JointState start = in_.continued;
    start.T_s = in_.window_prior.T_s;
    start.one_body = true;
    Candidate from_prior{"one-body", solve(start, in_.window_prior, in_.warped), false};
    return from_prior;
  }

  /// All pixels as one body, the camera prior almost ignored.
  JointFit dominantMotion() const {
    JointState start = in_.continued;
    start.T_s = in_.window_prior.T_s;
    start.one_body = true;
    JointPrior weak = in_.window_prior;
    weak.information_s *= decision_.dominant_prior;
    return solveJoint(in_.level, start, weak, in_.warped, *in_.adjacency, params_, terms_,
                      decision_.dominant_iterations);
  }

  /// Nothing is known of the body: what the dominant motion does not explain moves otherwise.
  /// Either the dominant motion is the world's, or it is the body's and the world moves as the
  /// camera prior says.
  Candidate splitByDominant(const JointFit& dominant, bool body_dominant) const {
    const ClusterEnergies e = clusterEnergies(in_.level, dominant, dominant.state.c);
    const double limit = medianEnergy(e) + params_.outlier_margin;
    JointState start;
    start.T_s = body_dominant ? in_.window_prior.T_s : dominant.state.T_s;
    start.T_d = dominant.state.T_s;
    for (const double energy : e.static_energy) {
      start.gamma.push_back((energy > limit) == body_dominant ? 1.0F : 0.0F);
    }
    const JointFit split = solveJoint(in_.level, start, in_.window_prior, weak_, *in_.adjacency,
                                      params_, terms_, decision_.iterations, true);
    return {body_dominant ? "object-dominant" : "camera-dominant",
            solve(split.state, in_.window_prior, weak_), false,
            body_dominant ? decision_.body_dominant_charge : 0.0};
  }

  Candidate fromMotions(const std::string& name, const SE3& T_s, const SE3& T_d) const {
    JointState start;
    start.T_s = T_s;
    start.T_d = T_d;
    start.gamma = scoresFromMotions(in_.level, start, in_.window_prior, weak_, *in_.adjacency,
                                    params_, terms_);
    return {name, solve(start, in_.window_prior, weak_), false};
  }

  /// At a slow start the dominant motion is neither body's: it lies between the two.
  Candidate between(const SE3& L) const {
    const SE3 half = SE3::exp(-0.5 * in_.window_prior.object_motion.log());
    const SE3 T_s = half * L;
    return fromMotions("between", T_s, in_.window_prior.expectedObject(T_s));
  }

  Candidate swapped(const Candidate& continued) const {
    JointState start = continued.fit.state;
    std::swap(start.T_s, start.T_d);
    for (float& g : start.gamma) g = 1.0F - g;
    ScorePrior target = in_.warped;
    for (float& g : target.target) g = 1.0F - g;
    return {"swap", solve(start, in_.window_prior, target), false};
  }

  Candidate restarted() const {
    JointState start;
    start.T_s = in_.window_prior.T_s;
    start.T_d = in_.window_prior.expectedObject(start.T_s);
    start.gamma.assign(in_.warped.target.size(), 1.0F);
    ScorePrior target = in_.warped;
    target.target.assign(target.target.size(), 1.0F);
    return {"restart", solve(start, in_.window_prior, target), false};
  }

 private:
  /// Over the pixels, of their clusters' energies as static.
  static double medianEnergy(const ClusterEnergies& e) {
    std::vector<std::pair<double, int>> sorted;
    int total = 0;
    for (std::size_t k = 0; k < e.pixels.size(); ++k) {
      sorted.emplace_back(e.static_energy[k], e.pixels[k]);
      total += e.pixels[k];
    }
    std::sort(sorted.begin(), sorted.end());
    int below = 0;
    for (const auto& [energy, pixels] : sorted) {
      below += pixels;
      if (2 * below >= total) return energy;
    }
    return 0;
  }

  JointFit solve(const JointState& start, const JointPrior& prior, const ScorePrior& scores) const {
    return solveJoint(in_.level, start, prior, scores, *in_.adjacency, params_, terms_,
                      decision_.iterations);
  }

  const DecisionInput& in_;
  const JointParams& params_;
  const DecisionParams& decision_;
  const ImageTermParams& terms_;
  ScorePrior weak_;
};

/// The readings of one frame in a fixed order, continuation first. Each is a chain of short solves
/// with little to share out in any: whole readings are solved side by side.
std::vector<Candidate> solveReadings(const Readings& readings, const DecisionInput& input) {
  const JointPrior& prior = input.window_prior;
  JointFit dominant;
  const SE3& L = dominant.state.T_s;
  if (prior.outlier_class) {
    std::vector<Candidate> out(input.camera_measured ? 5 : 3);
    parallelCalls({[&] { out[0] = readings.continued(); }, [&] { out[1] = readings.oneBody(); },
                   [&] { dominant = readings.dominantMotion(); }});
    const auto outliers = [&] { out[2] = readings.fromMotions("outliers", L, L); };
    if (input.camera_measured) {
      parallelCalls({outliers, [&] { out[3] = readings.splitByDominant(dominant, false); },
                     [&] { out[4] = readings.splitByDominant(dominant, true); }});
    } else {
      outliers();
    }
    return out;
  }
  const bool relative = prior.object == JointPrior::Object::kRelative;
  std::vector<Candidate> out(relative ? 7 : 6);
  Candidate& restarted = out.back();
  Candidate& swapped = out[out.size() - 2];
  parallelCalls({[&] { out[0] = readings.continued(); }, [&] { out[1] = readings.oneBody(); },
                 [&] { dominant = readings.dominantMotion(); },
                 [&] { restarted = readings.restarted(); }});
  parallelCalls(
      {[&] { out[2] = readings.fromMotions("camera-dominant", L, prior.expectedObject(L)); },
       [&] { out[3] = readings.fromMotions("object-dominant", prior.expectedCamera(L), L); },
       [&] {
         if (relative) out[4] = readings.between(L);
       },
       [&] { swapped = readings.swapped(out[0]); }});
  return out;
}

/// What a reading costs beside its prior: in the images and, where it is asked, on the map.
struct ReadingEnergy {
  double image = 0, map = 0;
};

std::vector<ReadingEnergy> readingEnergies(const std::vector<Candidate>& candidates,
                                           const DecisionInput& input, const JointParams& params,
                                           const ImageTermParams& terms,
                                           const MapEvidenceParams& map) {
  double c = std::numeric_limits<double>::max();
  for (const Candidate& k : candidates) c = std::min(c, k.fit.state.c);
  std::vector<ReadingEnergy> out(candidates.size());
  const int count = static_cast<int>(candidates.size());
  parallelChunks(count, [&](int i) {
    out[i].image = imageEnergy(input.level, candidates[i].fit, input.window_prior, params, c);
  });
  if (input.map == nullptr || !(map.decision_weight > 0)) return out;
  std::vector<double> noises(candidates.size());
  parallelChunks(count, [&](int i) {
    const SE3 T_MB = input.T_MA_static * candidates[i].fit.state.T_s;
    noises[i] = mapNoise(*input.map, *input.level.b, T_MB, terms, map);
  });
  const double noise = *std::min_element(noises.begin(), noises.end());
  parallelChunks(count, [&](int i) {
    const JointState& state = candidates[i].fit.state;
    const MapReading reading{input.T_MA_static * state.T_s, input.T_MA_object * state.T_d,
                             &state.gamma, noise};
    out[i].map = mapEnergy(*input.map, *input.level.b, *input.level.label, reading, terms, map,
                           params.outlier_margin);
  });
  return out;
}

double staticShare(const JointLevel& level, const std::vector<float>& gamma) {
  double sum = 0;
  double pixels = 0;
  for (const std::uint8_t k : *level.label) {
    if (k >= gamma.size()) continue;
    sum += static_cast<double>(gamma[k]);
    ++pixels;
  }
  return pixels > 0 ? sum / pixels : 1.0;
}

/// What the decision weighs of a reading.
struct Weighed {
  double image = 0;         ///< as negative log likelihood
  double total = 0;         ///< image, priors, map and charges; without one body's bonus
  double static_share = 1;  ///< of the pixels
};

std::vector<Weighed> weigh(const std::vector<Candidate>& candidates,
                           const std::vector<ReadingEnergy>& energies, const DecisionInput& input,
                           const DecisionParams& decision, double scale, double map_weight) {
  std::vector<Weighed> out(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const JointState& state = candidates[i].fit.state;
    Weighed& w = out[i];
    w.image = scale * energies[i].image;
    w.total = w.image + input.window_prior.cost(state.T_s, state.T_d) + candidates[i].charge +
              map_weight * scale * energies[i].map;
    if (state.one_body) continue;
    w.static_share = staticShare(input.level, state.gamma);
    if (i > 0) w.total += decision.switch_charge * out[0].image;
    if (w.static_share < decision.no_static_share) w.total += decision.no_static_charge;
  }
  return out;
}

}  // namespace

Decision decide(const DecisionInput& input, const JointParams& params,
                const DecisionParams& decision, const ImageTermParams& terms,
                const MapEvidenceParams& map) {
  const Readings readings(input, params, decision, terms);
  std::vector<Candidate> candidates = solveReadings(readings, input);
  const double scale = decision.reference_pixels / (2.0 * params.kappa);
  const std::vector<Weighed> weighed =
      weigh(candidates, readingEnergies(candidates, input, params, terms, map), input, decision,
            scale, map.decision_weight);
  const auto one = static_cast<std::size_t>(
      std::find_if(candidates.begin(), candidates.end(),
                   [](const Candidate& c) { return c.fit.state.one_body; }) -
      candidates.begin());
  const bool unannounced = input.window_prior.outlier_class && input.map == nullptr;
  const double most_image = (1.0 - decision.first_body_share) * weighed[one].image;
  std::size_t best = one;
  double energy = weighed[one].total - decision.one_body_bonus;
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    const Weighed& w = weighed[i];
    if (i == one || w.total >= energy) continue;
    const bool earned = w.image <= most_image && w.static_share >= decision.no_static_share;
    if (unannounced && !earned) continue;
    best = i;
    energy = w.total;
  }
  Decision out;
  out.body_seen = best != one;
  if (unannounced && !input.body_seen) best = one;
  out.name = candidates[best].name;
  out.continued = candidates[best].continued;
  out.fit = std::move(candidates[best].fit);
  return out;
}

}  // namespace rf
