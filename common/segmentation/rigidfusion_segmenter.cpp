// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/rigidfusion_segmenter.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/undistort.hpp"
#include "segmentation/clusters.hpp"
#include "segmentation/hypotheses.hpp"
#include "segmentation/map_evidence.hpp"
#include "segmentation/prior_filter.hpp"
#include "segmentation/prior_trust.hpp"

namespace rf {
namespace {

constexpr int kLevels = 3;  // working resolution and the two below it
constexpr int kMaskLevel = 0, kFineLevel = 1, kCoarseLevel = 2;

enum class ObjectPriorUse { kAll, kStart, kNone };

/// A processed frame that may serve as reference.
struct Past {
  std::int64_t utime = 0;
  bool usable = false;            ///< had enough depth
  std::vector<TermLevel> levels;  ///< [kMaskLevel..kCoarseLevel]; the mask level stays empty
  Image<float> mask_depth;        ///< at the mask level, only while the frame is the newest
  SE3 T_WC, T_CO;                 ///< own bookkeeping, refined by feedback
  bool camera_confirmed = false;  ///< tracked against the static map
  bool object_confirmed = false;  ///< tracked against its own model
  bool anchored = false;          ///< the models confirmed all that there is
  bool object_moves = false;
  Increment camera_source;  ///< the prior as given; measured: false when it is missing
  Increment object_source;
  Increment camera;            ///< accepted prior increment from the frame before
  Increment object;            ///< the same: T_Oa^-1 T_Ob, or T(xi_d) from kinematics
  Image<std::uint8_t> memory;  ///< last known scores, kept while the object rests
};

class Clock {
 public:
  void lap(const char* stage, StageTimes& out) {
    const auto now = std::chrono::steady_clock::now();
    out.emplace_back(stage, std::chrono::duration<double, std::milli>(now - last_).count());
    last_ = now;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

ObjectPriorUse useOf(const std::string& name) {
  if (name == "all") return ObjectPriorUse::kAll;
  if (name == "start") return ObjectPriorUse::kStart;
  if (name == "none") return ObjectPriorUse::kNone;
  throw std::invalid_argument("segmentation.object_prior_use = " + name +
                              ": must be all, start or none");
}

Mat6 inverseOf(const Mat6& covariance) {
  const Mat6 regular = covariance + 1e-12 * Mat6::Identity();
  return regular.ldlt().solve(Mat6::Identity());
}

/// Whether a camera may see a body there: what a start pose is checked by when nothing else can.
bool inView(const Vec3& t_CO) {
  constexpr double kFarthest = 8.0;  // metres, beyond any structured-light sensor
  constexpr double kWidest = 1.5;    // tangent, beyond any such camera's half angle
  return t_CO.z() > 0.1 && t_CO.z() < kFarthest && t_CO.head<2>().norm() < kWidest * t_CO.z();
}

float lookUp(const Image<std::uint8_t>& scores, const Camera& camera, const Vec3& p) {
  if (!(p.z() > 0.05)) return -1;
  const Eigen::Vector2d x = camera.project(p);
  const int u = static_cast<int>(std::lround(x.x()));
  const int v = static_cast<int>(std::lround(x.y()));
  return scores.inside(u, v) ? static_cast<float>(scores(u, v)) / 255.0F : -1.0F;
}

/// gamma~ (paper S_T): previous scores looked up through both motions and averaged. A body that
/// moves apart from the world needs its own motion, the world its own; the mean serves both sides
/// of a border.
ScorePrior warpScores(const Image<std::uint8_t>& previous, const Camera& mask_camera,
                      const TermLevel& level, const Image<std::uint8_t>& label,
                      std::size_t clusters, const SE3& step_s, const SE3& step_d) {
  std::vector<double> sum(clusters, 0.0);
  std::vector<int> count(clusters, 0);
  for (int v = 0; v < label.height(); ++v) {
    for (int u = 0; u < label.width(); ++u) {
      const std::uint8_t k = label(u, v);
      if (k >= clusters) continue;
      const Vec3 p = level.camera.backProject(u, v, static_cast<double>(level.depth(u, v)));
      for (const SE3* step : {&step_s, &step_d}) {
        const float g = lookUp(previous, mask_camera, *step * p);
        if (g < 0) continue;
        sum[k] += static_cast<double>(g);
        ++count[k];
      }
    }
  }
  ScorePrior out{std::vector<float>(clusters, 1.0F), std::vector<float>(clusters, 1.0F)};
  for (std::size_t k = 0; k < clusters; ++k) {
    if (count[k] > 0) out.target[k] = static_cast<float>(sum[k] / count[k]);
  }
  return out;
}

double share(const Image<std::uint8_t>& label, const std::vector<float>& gamma) {
  double dynamic = 0;
  double pixels = 0;
  for (const std::uint8_t k : label) {
    if (k >= gamma.size()) continue;
    dynamic += 1.0 - std::clamp(static_cast<double>(gamma[k]), 0.0, 1.0);
    ++pixels;
  }
  return pixels > 0 ? dynamic / pixels : 0;
}

Image<std::uint8_t> scoreImage(const Image<std::uint8_t>& label, const std::vector<float>& gamma) {
  Image<std::uint8_t> out(label.width(), label.height(), 255);
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] < gamma.size()) {
      out[i] =
          static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(gamma[label[i]], 0.0F, 1.0F)));
    }
  }
  return out;
}

}  // namespace

struct RigidFusionSegmenter::Impl {
  Impl(const SegmentationConfig& segmentation_config, const Camera& input_camera)
      : config(segmentation_config),
        camera(input_camera),
        undistorter(input_camera),
        object_prior_use(useOf(config.object_prior_use)),
        camera_filter({config.camera_spread_m, config.camera_spread_rad}),
        object_filter({config.object_spread_m, config.object_spread_rad}),
        camera_trust(config.prior_trust),
        object_trust(config.prior_trust),
        object_anchored(object_prior_use != ObjectPriorUse::kNone) {}

  SegmentationConfig config;
  Camera camera;
  Undistorter undistorter;
  ObjectPriorUse object_prior_use;
  PriorFilter camera_filter, object_filter;
  PriorTrust camera_trust, object_trust;
  std::deque<Past> past;       ///< oldest first
  std::optional<MapView> map;  ///< both models as seen from ...
  SE3 T_WM, T_MO;              ///< ... this camera, and where the body was then
  std::optional<SE3> last_camera_step;
  std::optional<SE3> last_object_step;    ///< T_Oa^-1 T_Ob in the world
  std::optional<SE3> last_object_motion;  ///< T(xi_d)
  bool object_prior_seen = false;
  int agreed_frames = 0;  ///< with two bodies, both confirmed, and the camera prior in agreement
  bool object_anchored;   ///< the object prior is used; its world is the camera's
  bool kinematic_object = false;  ///< the prior is T_CO, independent of the camera's own motion

  SegmentationResult process(const RgbdFrame& frame, const MotionPrior& prior,
                             const ModelState* feedback);
  void applyFeedback(const ModelState* feedback);
  void judgePriors(std::size_t at);
  void startPoses(const MotionPrior& prior, Past& now);
  void acceptPriors(const MotionPrior& prior, Past& now);
  const Past* reference(const Past& now) const;
  JointPrior windowPrior(const Past& reference, const Past& now) const;
  JointPrior stepPrior(const Past& reference, const Past& now) const;
  JointPrior makePrior(const SE3& T_s, const Mat6& cov_s, const Past& at,
                       const Increment& object) const;
  static JointLevel levelOf(const Past& reference, const Past& now, const Clusters& clusters,
                            std::size_t level);
  DecisionInput decisionInput(const Past& reference, const Past& now,
                              const Clusters& clusters) const;
  JointFit refine(const Past& reference, const Past& now, const Clusters& clusters,
                  const DecisionInput& input, const Decision& decision) const;
  void takeMotions(const JointFit& fit, const Past& reference, Past& now,
                   SegmentationResult& out) const;
  void takeMask(const JointFit& fit, const Past& reference, const Clusters& clusters,
                const JointPrior& prior, Past& now, SegmentationResult& out) const;
  void estimate(const Past& reference, const Clusters& clusters, Past& now, SegmentationResult& out,
                Clock& clock);
  bool mature() const { return agreed_frames >= config.mature_frames; }
  Camera maskCamera() const { return camera.undistorted().reduced(config.reduction); }
  void coast(Past& now, SegmentationResult& out) const;
  void finish(Past& now, SegmentationResult& out);
};

void RigidFusionSegmenter::Impl::applyFeedback(const ModelState* feedback) {
  map.reset();
  if (feedback == nullptr || past.empty() || !config.use_feedback) return;
  for (std::size_t i = 0; i < past.size(); ++i) {
    Past& p = past[i];
    if (p.utime != feedback->utime) continue;
    p.camera_confirmed = feedback->camera.health == Health::kTracked;
    p.object_confirmed = p.camera_confirmed && feedback->object_exists &&
                         feedback->object.health == Health::kTracked;
    p.anchored = p.camera_confirmed && (!feedback->object_exists || p.object_confirmed);
    if (p.camera_confirmed) {
      p.T_WC = feedback->camera.T_W;
      if (p.object_confirmed && object_prior_seen) {
        p.T_CO = p.T_WC.inverse() * feedback->object.T_W;
      }
      judgePriors(i);
      if (feedback->object_exists && config.map.weight > 0) {
        map = MapView{camera.undistorted().reduced(feedback->reduction),
                      feedback->predicted_depth_mm, feedback->body};
        T_WM = p.T_WC;
        T_MO = p.T_CO;
      }
    }
  }
}

/// What the sources said of a frame whose poses are now known.
void RigidFusionSegmenter::Impl::judgePriors(std::size_t at) {
  const Past& p = past[at];
  const Past* before = at > 0 ? &past[at - 1] : nullptr;
  if (p.camera_source.measured && p.object_confirmed && p.object_moves && !mature()) {
    agreed_frames = camera_trust.translationFactor() > 1.0 ? 0 : agreed_frames + 1;
  }
  camera_trust.observe(p.camera_source, p.T_WC, before != nullptr && before->camera_confirmed);
  if (!p.object_confirmed || !object_prior_seen) return;
  const SE3 pose = kinematic_object ? p.T_CO.inverse() : p.T_WC * p.T_CO;
  object_trust.observe(p.object_source, pose, before != nullptr && before->object_confirmed);
}

void RigidFusionSegmenter::Impl::startPoses(const MotionPrior& prior, Past& now) {
  if (prior.camera != PriorState::kMissing) now.T_WC = prior.T_WCb;
  if (prior.object == PriorState::kMissing || !object_anchored) return;
  if (prior.object_kind == ObjectPriorKind::kCameraFrame) {
    now.T_CO = prior.T_XOb;
  } else if (prior.object_kind == ObjectPriorKind::kWorldFrame) {
    now.T_CO = now.T_WC.inverse() * prior.T_XOb;  // both sources as given, before any drift
    // Without a camera pose the object's world may be any: its directions would be noise.
    object_anchored = prior.camera != PriorState::kMissing || inView(now.T_CO.t);
  }
}

void RigidFusionSegmenter::Impl::acceptPriors(const MotionPrior& prior, Past& now) {
  std::optional<SE3> camera_prior;
  if (prior.camera != PriorState::kMissing) {
    camera_prior = prior.T_CaCb;
    now.camera_source = {prior.T_CaCb, prior.camera_cov, true, false};
  }
  // A start with labels swapped must not talk the only witness against it down.
  const bool may_adapt = object_prior_seen || mature();
  now.camera = camera_filter.accept(
      camera_prior, may_adapt ? camera_trust.adapted(prior.camera_cov) : prior.camera_cov,
      last_camera_step);
  std::optional<SE3> object_prior;
  if (object_anchored && prior.object != PriorState::kMissing &&
      prior.object_kind != ObjectPriorKind::kNone) {
    kinematic_object = prior.object_kind == ObjectPriorKind::kCameraFrame;
    const SE3 given = kinematic_object ? prior.T_XOa * prior.T_XOb.inverse()
                                       : prior.T_XOa.inverse() * prior.T_XOb;
    object_prior_seen = true;
    now.object_source = {given, prior.object_cov, true, false};
    if (object_prior_use == ObjectPriorUse::kAll || !mature()) object_prior = given;
  }
  now.object = object_filter.accept(object_prior, object_trust.adapted(prior.object_cov),
                                    kinematic_object ? last_object_motion : last_object_step);
}

const Past* RigidFusionSegmenter::Impl::reference(const Past& now) const {
  const Past* best = nullptr;
  const Past* anchored = nullptr;  // of poses that are off nothing good can be chained
  const SE3 T_WC = past.back().T_WC * now.camera.T;
  int back = 0;
  for (auto p = past.rbegin(); p != past.rend() && back < config.window_frames; ++p, ++back) {
    if (!p->usable) continue;
    const double age = 1e-6 * static_cast<double>(now.utime - p->utime);
    const SE3 relative = p->T_WC.inverse() * T_WC;
    const bool overlaps = relative.log().tail<3>().norm() < config.window_rotation_rad;
    if (best != nullptr && (age > config.window_s || !overlaps)) break;
    best = &*p;
    if (back > 0 && p->anchored) anchored = best;
  }
  return anchored != nullptr ? anchored : best;
}

JointPrior RigidFusionSegmenter::Impl::makePrior(const SE3& T_s, const Mat6& cov_s, const Past& at,
                                                 const Increment& object) const {
  JointPrior out;
  out.T_s = T_s;
  out.information_s = inverseOf(cov_s);
  out.object = JointPrior::Object::kRelative;
  if (!object_prior_seen) {
    // No object prior at all: what the body did last, loosely; the outlier rule seeds the mask.
    out.outlier_class = true;
    out.object_motion = SE3();
    Mat6 loose = covarianceOf({config.free_object_m, config.free_object_rad});
    out.information_d = inverseOf(loose);
    return out;
  }
  if (kinematic_object) {
    out.object = JointPrior::Object::kAbsolute;
    out.object_motion = object.T;
    out.information_d = inverseOf(object.covariance);
    return out;
  }
  out.object_motion = at.T_CO * object.T.inverse() * at.T_CO.inverse();
  const Mat6 A = at.T_CO.inverse().adjoint();
  out.information_d = A.transpose() * inverseOf(object.covariance) * A;
  return out;
}

JointPrior RigidFusionSegmenter::Impl::windowPrior(const Past& ref, const Past& now) const {
  Increment camera_sum{SE3(), Mat6::Zero(), true, false};
  Increment object_sum = camera_sum;
  const auto add = [&](const Past& p) {
    camera_sum = compose(camera_sum, p.camera);
    object_sum = compose(object_sum, p.object);
  };
  for (const Past& p : past) {
    if (p.utime > ref.utime) add(p);
  }
  add(now);
  return makePrior(camera_sum.T, camera_sum.covariance, ref, object_sum);
}

JointPrior RigidFusionSegmenter::Impl::stepPrior(const Past& ref, const Past& now) const {
  const Past& last = past.back();
  const SE3 chain_s = ref.T_WC.inverse() * last.T_WC;
  Increment object = now.object;
  Mat6 camera_covariance = now.camera.covariance;
  if (!ref.anchored || !last.anchored) {
    const Mat6 chain = covarianceOf({config.chain_spread_m, config.chain_spread_rad});
    camera_covariance += chain;
    object.covariance += chain;
  }
  JointPrior step = makePrior(chain_s * now.camera.T, camera_covariance, last, object);
  const SE3 chain_d = ref.T_CO * last.T_CO.inverse();
  step.object_motion = step.object == JointPrior::Object::kAbsolute
                           ? chain_d * step.object_motion
                           : chain_d * step.object_motion * chain_s.inverse();
  return step;
}

void RigidFusionSegmenter::Impl::coast(Past& now, SegmentationResult& out) const {
  const Past& last = past.back();
  now.T_WC = last.T_WC * now.camera.T;
  const SE3 T_WO = last.T_WC * last.T_CO * (object_prior_seen ? now.object.T : SE3());
  now.T_CO = kinematic_object ? now.object.T.inverse() * last.T_CO : now.T_WC.inverse() * T_WO;
  out.camera.health = now.camera.measured ? Health::kPriorOnly : Health::kLost;
  out.camera.covariance = now.camera.covariance;
  out.object.health = object_prior_seen && now.object.measured ? Health::kPriorOnly : Health::kLost;
  out.object.covariance = now.object.covariance;
  out.hypothesis = "no-image";
  now.memory = last.memory;
}

JointLevel RigidFusionSegmenter::Impl::levelOf(const Past& ref, const Past& now,
                                               const Clusters& clusters, std::size_t level) {
  return {&ref.levels[level], &now.levels[level], &clusters.label[level]};
}

DecisionInput RigidFusionSegmenter::Impl::decisionInput(const Past& ref, const Past& now,
                                                        const Clusters& clusters) const {
  const Past& last = past.back();
  DecisionInput input;
  input.level = levelOf(ref, now, clusters, kCoarseLevel);
  input.window_prior = windowPrior(ref, now);
  input.step_prior = stepPrior(ref, now);
  input.adjacency = &clusters.adjacency;
  input.camera_measured = now.camera.measured;
  const SE3 chain_s = ref.T_WC.inverse() * last.T_WC;
  const SE3 chain_d = ref.T_CO * last.T_CO.inverse();
  input.continued.T_s = input.step_prior.T_s;
  input.continued.T_d = input.step_prior.expectedObject(input.continued.T_s);
  if (!object_prior_seen && last_object_step) {
    input.continued.T_d = chain_d * last.T_CO * last_object_step->inverse() * last.T_CO.inverse() *
                          chain_s.inverse() * input.continued.T_s;
  }
  input.warped =
      warpScores(last.memory, maskCamera(), now.levels[kCoarseLevel], clusters.label[kCoarseLevel],
                 clusters.centres.size(), chain_s.inverse() * input.continued.T_s,
                 chain_d.inverse() * input.continued.T_d);
  input.continued.gamma = input.warped.target;
  // Where a prior can decide, a map that it has not confirmed yet might only confirm a wrong start.
  const bool no_prior = !object_prior_seen && !now.camera.measured;
  if (map && (no_prior || mature())) {
    input.map = &*map;
    input.T_MA_static = T_WM.inverse() * ref.T_WC;
    input.T_MA_object = T_MO * ref.T_CO.inverse();
  }
  return input;
}

JointFit RigidFusionSegmenter::Impl::refine(const Past& ref, const Past& now,
                                            const Clusters& clusters, const DecisionInput& input,
                                            const Decision& decision) const {
  const JointLevel fine = levelOf(ref, now, clusters, kFineLevel);
  const JointPrior& prior = decision.continued ? input.step_prior : input.window_prior;
  const JointState& found = decision.fit.state;
  ScorePrior scores = input.warped;
  if (!decision.continued) scores.target = found.gamma;
  if (map && !found.one_body) {
    const Image<MapWitness> witnesses =
        mapWitnesses(*map, fine.b->camera, fine.b->depth, T_WM.inverse() * ref.T_WC * found.T_s,
                     T_MO * ref.T_CO.inverse() * found.T_d, config.terms, config.map);
    addMapEvidence(witnesses, *fine.label,
                   bodyAdvantages(input.level, decision.fit, prior, config.joint), config.map,
                   scores);
  }
  return solveJoint(fine, found, prior, scores, clusters.adjacency, config.joint, config.terms,
                    config.fine_iterations);
}

void RigidFusionSegmenter::Impl::takeMotions(const JointFit& fit, const Past& ref, Past& now,
                                             SegmentationResult& out) const {
  const Past& last = past.back();
  const JointState& state = fit.state;
  now.T_WC = ref.T_WC * state.T_s;
  const Mat12 covariance = fit.information.ldlt().solve(Mat12::Identity());
  out.camera.covariance = covariance.topLeftCorner<6, 6>();
  out.camera.inliers = fit.inliers_s;
  out.camera.rms_residual = fit.rms_s;
  if (state.one_body) {
    now.T_CO = now.T_WC.inverse() * last.T_WC * last.T_CO;  // it rests in the world
    out.object = out.camera;
  } else {
    now.T_CO = state.T_d.inverse() * ref.T_CO;
    out.object.covariance = covariance.bottomRightCorner<6, 6>();
    out.object.inliers = fit.inliers_d;
    out.object.rms_residual = fit.rms_d;
  }
  const double pixels = static_cast<double>(now.levels[kFineLevel].depth.size());
  const auto judge = [&](BodyMotion& body, bool prior_used) {
    if (body.inliers < config.lost_inlier_share * pixels) {
      body.health = prior_used ? Health::kPriorOnly : Health::kLost;
    } else {
      body.health = body.inliers < config.degraded_inlier_share * pixels ? Health::kDegraded
                                                                         : Health::kTracked;
    }
  };
  judge(out.camera, now.camera.measured);
  judge(out.object, object_prior_seen && now.object.measured);
}

void RigidFusionSegmenter::Impl::takeMask(const JointFit& fit, const Past& ref,
                                          const Clusters& clusters, const JointPrior& prior,
                                          Past& now, SegmentationResult& out) const {
  const Past& last = past.back();
  out.gamma = fit.state.gamma;
  out.label = clusters.label[kMaskLevel];
  out.score = scoreImage(out.label, out.gamma);
  out.dynamic_share = share(out.label, out.gamma);
  if (fit.state.one_body) {
    // What is known while everything rests: the last two-body scores, moved with the world.
    const SE3 step = last.T_WC.inverse() * now.T_WC;
    const ScorePrior kept =
        warpScores(last.memory, maskCamera(), now.levels[kCoarseLevel],
                   clusters.label[kCoarseLevel], clusters.centres.size(), step, step);
    now.memory = scoreImage(out.label, kept.target);
    return;
  }
  if (map && config.map.pixel_weight > 0) {
    const Image<MapWitness> witnesses =
        mapWitnesses(*map, maskCamera(), now.mask_depth, T_WM.inverse() * now.T_WC,
                     T_MO * now.T_CO.inverse(), config.terms, config.map);
    const std::vector<double> advantage =
        bodyAdvantages(levelOf(ref, now, clusters, kFineLevel), fit, prior, config.joint);
    out.score = refineScores(witnesses, now.mask_depth, out.label, out.gamma, advantage,
                             clusters.adjacency, config.map);
  }
  now.memory = out.score;
}

void RigidFusionSegmenter::Impl::estimate(const Past& ref, const Clusters& clusters, Past& now,
                                          SegmentationResult& out, Clock& clock) {
  const DecisionInput input = decisionInput(ref, now, clusters);
  const Decision decision = decide(input, config.joint, config.decision, config.terms, config.map);
  clock.lap("decide", out.stage_ms);
  const JointFit fit = refine(ref, now, clusters, input, decision);
  clock.lap("refine", out.stage_ms);
  out.hypothesis = decision.name;
  out.object_moving = !fit.state.one_body;
  takeMotions(fit, ref, now, out);
  takeMask(fit, ref, clusters, input.window_prior, now, out);
  clock.lap("mask", out.stage_ms);
}

void RigidFusionSegmenter::Impl::finish(Past& now, SegmentationResult& out) {
  const Past& last = past.back();
  out.camera.T_AB = last.T_WC.inverse() * now.T_WC;
  out.object.T_AB = last.T_CO * now.T_CO.inverse();
  now.object_moves = out.object_moving;
  last_camera_step = out.camera.T_AB;
  last_object_motion = out.object.T_AB;
  const SE3 T_WO_a = last.T_WC * last.T_CO;
  last_object_step = T_WO_a.inverse() * now.T_WC * now.T_CO;
  if (!now.camera.measured && out.camera.health == Health::kTracked) {
    // No other witness: the estimate itself is what later windows may lean on.
    now.camera.T = out.camera.T_AB;
    now.camera.covariance = covarianceOf({config.estimate_spread_m, config.estimate_spread_rad});
  }
}

SegmentationResult RigidFusionSegmenter::Impl::process(const RgbdFrame& frame,
                                                       const MotionPrior& prior,
                                                       const ModelState* feedback) {
  Clock clock;
  SegmentationResult out;
  applyFeedback(feedback);
  Past now;
  now.utime = frame.utime;
  RgbdLevel finest =
      reduceFrame(undistorter.colour(frame.colour), undistorter.depth(frame.depth_mm),
                  camera.undistorted(), config.reduction, config.min_depth_m, config.max_depth_m);
  const std::size_t pixels = finest.depth.size();
  const auto measured =
      std::count_if(finest.depth.begin(), finest.depth.end(), [](float z) { return z > 0; });
  now.usable =
      static_cast<double>(measured) >= config.min_depth_share * static_cast<double>(pixels);
  const std::vector<RgbdLevel> pyramid = buildPyramid(std::move(finest), kLevels);
  now.levels.resize(kLevels);
  for (int level = kFineLevel; level < kLevels; ++level)
    now.levels[level] = makeTermLevel(pyramid[level]);
  now.mask_depth = pyramid[kMaskLevel].depth;
  clock.lap("prepare", out.stage_ms);
  const Clusters clusters = clusterFrame(pyramid, config.clusters);
  clock.lap("cluster", out.stage_ms);

  out.utime = frame.utime;
  out.seq = frame.seq;
  out.reduction = config.reduction;
  out.label = clusters.label[kMaskLevel];
  out.gamma.assign(clusters.centres.size(), 1.0F);
  out.score = scoreImage(out.label, out.gamma);
  if (past.empty()) {
    out.first = true;
    startPoses(prior, now);
    object_prior_seen = object_anchored && prior.object != PriorState::kMissing;
    now.memory = out.score;
    out.hypothesis = "first";
    out.camera.health = out.object.health = now.usable ? Health::kTracked : Health::kLost;
    out.utime_a = frame.utime;
  } else {
    out.utime_a = past.back().utime;
    acceptPriors(prior, now);
    const Past* ref = now.usable ? reference(now) : nullptr;
    if (ref != nullptr) {
      estimate(*ref, clusters, now, out, clock);
    } else {
      coast(now, out);
    }
    finish(now, out);
  }
  out.has_prior_T_WC = prior.camera != PriorState::kMissing;
  if (out.has_prior_T_WC) out.prior_T_WC = prior.T_WCb;
  out.has_T_CO = object_prior_seen;
  if (out.has_T_CO) out.T_CO = now.T_CO;
  now.mask_depth = {};
  past.push_back(std::move(now));
  while (past.size() > static_cast<std::size_t>(config.window_frames)) past.pop_front();
  return out;
}

RigidFusionSegmenter::RigidFusionSegmenter(const SegmentationConfig& config, const Camera& camera)
    : impl_(std::make_unique<Impl>(config, camera)) {}
RigidFusionSegmenter::~RigidFusionSegmenter() = default;
RigidFusionSegmenter::RigidFusionSegmenter(RigidFusionSegmenter&&) noexcept = default;

SegmentationResult RigidFusionSegmenter::process(const RgbdFrame& frame, const MotionPrior& prior,
                                                 const ModelState* feedback) {
  return impl_->process(frame, prior, feedback);
}

void RigidFusionSegmenter::reset() { impl_ = std::make_unique<Impl>(impl_->config, impl_->camera); }

}  // namespace rf
