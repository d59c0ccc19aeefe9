// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/parallel.hpp"
#include "segmentation/border_sides.hpp"

namespace rf {
namespace {

struct Candidate {
  std::string name;
  JointFit fit;
  bool continued = false;
  double charge = 0;    ///< beside what every reading pays
  bool turned = false;  ///< an unannounced split, read the other way round
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
    return {"one-body", solve(start, in_.window_prior, in_.warped), false};
  }

  /// One body too, begun from a motion that was found: a prior that is off by more than a
  /// short solve can make good must not make one body look bad.
  Candidate oneBodyFrom(const JointFit& found) const {
    JointState start = found.state;
    start.one_body = true;
    return {"one-body", solve(start, in_.window_prior, in_.warped), false};
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
    const bool charged = in_.camera_tells || in_.map != nullptr;  // else by its size
    return {body_dominant ? "object-dominant" : "camera-dominant",
            solve(split.state, in_.window_prior, weak_), false,
            body_dominant && charged ? decision_.body_dominant_charge : 0.0};
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

  /// What nothing announced may have been read the wrong way round.
  Candidate turned(const Candidate& split) const {
    Candidate out{"swap", solve(swappedState(split.fit.state), in_.window_prior, weak_), false};
    out.turned = true;
    return out;
  }

  Candidate swapped(const Candidate& continued) const {
    const JointState start = swappedState(continued.fit.state);
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
  static JointState swappedState(JointState state) {
    std::swap(state.T_s, state.T_d);
    for (float& g : state.gamma) g = 1.0F - g;
    return state;
  }

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

/// No prior tells which of two bodies is the world.
bool untold(const DecisionInput& input) {
  return input.window_prior.outlier_class && !input.camera_tells;
}

/// The readings where no object prior says how a body moves, in a fixed order; where nothing tells
/// which body is the world, the splits both ways round.
std::vector<Candidate> solveUnannounced(const Readings& readings, const DecisionInput& input) {
  const bool split = input.camera_measured;
  const bool both_ways = untold(input);
  const std::size_t told = split ? 7 : 5;
  std::vector<Candidate> out(told + (both_ways ? (split ? 2 : 1) : 0));
  JointFit dominant;
  const SE3& L = dominant.state.T_s;
  parallelCalls({[&] { out[0] = readings.continued(); }, [&] { out[1] = readings.oneBody(); },
                 [&] { dominant = readings.dominantMotion(); }});
  parallelCalls({[&] { out[2] = readings.oneBodyFrom(dominant); },
                 [&] { out[3] = readings.oneBodyFrom(out[0].fit); },
                 [&] { out[4] = readings.fromMotions("outliers", L, L); },
                 [&] {
                   if (split) out[5] = readings.splitByDominant(dominant, false);
                 },
                 [&] {
                   if (split) out[6] = readings.splitByDominant(dominant, true);
                 }});
  if (!both_ways) return out;
  parallelCalls({[&] { out[told] = readings.turned(out[4]); },
                 [&] {
                   if (split) out[told + 1] = readings.turned(out[5]);
                 }});
  return out;
}

/// The readings of one frame in a fixed order, continuation first. Each is a chain of short solves
/// with little to share out in any: whole readings are solved side by side.
std::vector<Candidate> solveReadings(const Readings& readings, const DecisionInput& input) {
  const JointPrior& prior = input.window_prior;
  JointFit dominant;
  const SE3& L = dominant.state.T_s;
  if (prior.outlier_class) return solveUnannounced(readings, input);
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

/// A body that no prior announced and no model knows.
bool unannounced(const DecisionInput& input) {
  return input.window_prior.outlier_class && input.map == nullptr;
}

/// How unlikely a world of that share of the view is: log odds of the body's share, none up to
/// half.
double smallWorld(double static_share) {
  constexpr double kLeast = 1e-3;
  const double share = std::clamp(static_share, kLeast, 0.5);
  return std::log((1.0 - share) / share);
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
    if (unannounced(input) && untold(input)) {
      const BorderSides sides = borderSides(input.level.b->depth, *input.level.label, state.gamma);
      w.total += decision.small_world_charge * smallWorld(w.static_share) +
                 decision.body_behind_charge * bodyBehind(sides);
    }
    if (i > 0) w.total += decision.switch_charge * out[0].image;
    if (w.static_share < decision.no_static_share) w.total += decision.no_static_charge;
  }
  return out;
}

/// A reading that a rest does not end.
bool lasted(const DecisionInput& input, const DecisionParams& decision) {
  return input.moved_frames >= decision.lasted_frames;
}

/// Whether a reading takes the body for the world and the world for it: that of the frame before,
/// or one that has lasted and rests, of which more than half of either must have changed. Less is
/// no exchange there: a new start is seen by a few clusters first.
bool exchanges(const DecisionInput& input, const JointState& state,
               const DecisionParams& decision) {
  if (state.one_body || !(input.body_moved || lasted(input, decision))) return false;
  const std::vector<float>& before = input.warped.target;
  double pixels = 0;
  double body = 0;
  double body_as_world = 0;
  double world_as_body = 0;
  for (const std::uint8_t k : *input.level.label) {
    if (k >= state.gamma.size()) continue;
    const double change = static_cast<double>(state.gamma[k] - before[k]);
    body += static_cast<double>(before[k]);
    body_as_world += std::max(-change, 0.0);
    world_as_body += std::max(change, 0.0);
    ++pixels;
  }
  if (input.body_moved) return body_as_world + world_as_body > 0.5 * pixels;
  return body_as_world > 0.5 * body && world_as_body > 0.5 * (pixels - body);
}

/// The same against a world that has a claim: it was the larger part, or it has lasted.
bool contradicts(const DecisionInput& input, const JointState& state,
                 const DecisionParams& decision) {
  if (!exchanges(input, state, decision)) return false;
  return input.moved_frames - input.turned_frames >= decision.lasted_frames ||
         staticShare(input.level, input.warped.target) >= 0.5;
}

/// How long the contrary of a reading has to win: where nothing tells, the whole time; else half as
/// long as the reading lasted undisputed, so that a wrong start is soon mended and a slow moment
/// turns nothing.
int framesToTurn(const DecisionInput& input, const DecisionParams& decision) {
  const int half = (input.moved_frames - input.turned_frames) / 2;
  return untold(input) ? decision.turn_frames : std::min(decision.turn_frames, half);
}

/// The cheaper of the readings with one body: there can be two.
std::size_t bestOneBody(const std::vector<Candidate>& candidates,
                        const std::vector<Weighed>& weighed) {
  std::size_t best = candidates.size();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].fit.state.one_body) continue;
    if (best == candidates.size() || weighed[i].total < weighed[best].total) best = i;
  }
  return best;
}

/// Among all readings, or among those that leave mask and world as they were.
std::size_t lowest(const std::vector<Candidate>& candidates, const std::vector<Weighed>& weighed,
                   const DecisionInput& input, const DecisionParams& decision, bool turning) {
  const std::size_t one = bestOneBody(candidates, weighed);
  const double most_image = (1.0 - decision.first_body_share) * weighed[one].image;
  std::size_t best = one;
  const bool known = lasted(input, decision);
  const bool had_world = staticShare(input.level, input.warped.target) >= 0.5;
  double energy =
      weighed[one].total - (known ? decision.known_body_bonus : decision.one_body_bonus);
  for (std::size_t i = 0; i < weighed.size(); ++i) {
    const Weighed& w = weighed[i];
    const JointState& state = candidates[i].fit.state;
    if (state.one_body || w.total >= energy) continue;
    const bool has_world = w.static_share >= decision.no_static_share;
    if (unannounced(input) && !(w.image <= most_image && has_world)) continue;
    if (!has_world && had_world) continue;  // no body fills the view from one frame to the next
    if (candidates[i].turned && !input.body_moved && w.static_share < 0.5) continue;
    if (!turning && contradicts(input, state, decision)) continue;
    best = i;
    energy = w.total;
  }
  return best;
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
  const std::size_t one = bestOneBody(candidates, weighed);
  Decision out;
  std::size_t best = lowest(candidates, weighed, input, decision, true);
  const bool turned_birth = candidates[best].turned && !input.body_moved;
  const bool turns = contradicts(input, candidates[best].fit.state, decision);
  if (turned_birth || turns) out.turned_frames = input.turned_frames + 1;
  if (turns && out.turned_frames < framesToTurn(input, decision)) {
    best = lowest(candidates, weighed, input, decision, false);
  }
  out.body_seen = best != one;
  // Blur reads a resting world once this way, once that; a body is read the same way twice.
  const bool twice = input.body_seen && (!turned_birth || out.turned_frames > 1);
  if (unannounced(input) && !twice) best = one;
  out.turned =
      input.window_prior.outlier_class && exchanges(input, candidates[best].fit.state, decision);
  out.name = candidates[best].name;
  out.continued = candidates[best].continued;
  out.fit = std::move(candidates[best].fit);
  return out;
}

}  // namespace rf
