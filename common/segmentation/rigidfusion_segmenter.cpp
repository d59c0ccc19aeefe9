// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/rigidfusion_segmenter.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "segmentation/clusters.hpp"
#include "segmentation/hypotheses.hpp"
#include "segmentation/map_evidence.hpp"
#include "segmentation/past_frame.hpp"
#include "segmentation/prior_filter.hpp"
#include "segmentation/prior_intake.hpp"
#include "segmentation/score_images.hpp"
#include "segmentation/settling.hpp"
#include "values/stage_clock.hpp"
#include "values/swap_doubt.hpp"
#include "values/usual_residual.hpp"

namespace rf {
namespace {

constexpr int kLevels = 3;  // working resolution and the two below it
constexpr int kMaskLevel = 0, kFineLevel = 1, kCoarseLevel = 2;

/// A frame's motions and labels, and what they were found from.
struct Solution {
  JointPrior window_prior;
  Decision decision;
  JointFit fit;
};

}  // namespace

struct RigidFusionSegmenter::Impl {
  Impl(const SegmentationConfig& segmentation_config, const Camera& input_camera)
      : config(segmentation_config),
        camera(input_camera),
        preparer(segmentation_config, input_camera,
                 {kLevels, segmentation_config.clusters.count, true}),
        priors(config),
        settling(config.settle_frames) {}

  SegmentationConfig config;
  Camera camera;
  FramePreparer preparer;
  PriorIntake priors;
  std::deque<PastFrame> past;  ///< oldest first
  std::optional<MapView> map;  ///< both models as seen from ...
  SE3 T_WM, T_MO;              ///< ... this camera, and where the body was then
  LastMotion last_motion;
  UsualResidual usual;
  Settling settling;
  SwapDoubt swap;

  SegmentationResult process(PreparedFrame frame, const MotionPrior& prior,
                             const ModelState* feedback);
  bool onModel(const BodyPose& pose) const;
  void applyFeedback(const ModelState* feedback);
  const PastFrame* reference(const PastFrame& now) const;
  static JointLevel levelOf(const PastFrame& reference, const PastFrame& now,
                            const Clusters& clusters, std::size_t level);
  DecisionInput decisionInput(const PastFrame& reference, const PastFrame& now,
                              const Clusters& clusters) const;
  JointFit refine(const PastFrame& reference, const PastFrame& now, const Clusters& clusters,
                  const DecisionInput& input, const Decision& decision) const;
  Solution solve(const PastFrame& reference, const PastFrame& now, const Clusters& clusters,
                 const DecisionInput& input, StageTimes& times) const;
  void distrustPrior(const PastFrame& reference, const Clusters& clusters, PastFrame& now,
                     Solution& solution, StageTimes& times) const;
  void takeMotions(const JointFit& fit, const PastFrame& reference, PastFrame& now,
                   SegmentationResult& out) const;
  void turnMotions(const JointState& state, const PastFrame& reference, PastFrame& now) const;
  void takeMask(const JointFit& fit, const PastFrame& reference, const Clusters& clusters,
                const JointPrior& prior, PastFrame& now, SegmentationResult& out) const;
  int framesMoved(const PastFrame& last, const Decision& decision) const;
  void estimate(const PastFrame& reference, const Clusters& clusters, PastFrame& now,
                SegmentationResult& out);
  Camera maskCamera() const { return camera.undistorted().reduced(config.reduction); }
  void coast(PastFrame& now, SegmentationResult& out) const;
  void finish(PastFrame& now, SegmentationResult& out);
  void learnSteps(const PastFrame& before, PastFrame& now);
  std::optional<SE3>& objectStep() {
    return priors.kinematicObject() ? last_motion.object_motion : last_motion.object;
  }
};

bool RigidFusionSegmenter::Impl::onModel(const BodyPose& pose) const {
  if (pose.health == Health::kTracked) return true;
  // In doubt for one reason only: which body is the world. On its model it is as right as before.
  const Eigen::Matrix3d position = pose.covariance.topLeftCorner<3, 3>();
  return swap.possible() && pose.health == Health::kDegraded &&
         position.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff() >
             kTrustedSigma * kTrustedSigma;
}

void RigidFusionSegmenter::Impl::applyFeedback(const ModelState* feedback) {
  map.reset();
  if (feedback == nullptr || past.empty() || !config.use_feedback) return;
  for (std::size_t i = 0; i < past.size(); ++i) {
    PastFrame& p = past[i];
    if (p.utime != feedback->utime) continue;
    p.camera_confirmed = onModel(feedback->camera);
    // Without a camera prior nothing will tell, and the model would hold a wrong reading for ever.
    p.object_confirmed = p.camera_confirmed && feedback->object_exists &&
                         (p.camera_source.measured ? onModel(feedback->object)
                                                   : feedback->object.health == Health::kTracked);
    p.anchored = p.camera_confirmed && (!feedback->object_exists || p.object_confirmed);
    if (p.camera_confirmed) {
      p.T_WC = feedback->camera.T_W;
      if (p.object_confirmed && priors.objectSeen()) {
        p.T_CO = p.T_WC.inverse() * feedback->object.T_W;
      }
      if (i > 0) learnSteps(past[i - 1], p);
      priors.judge(p, i > 0 ? &past[i - 1] : nullptr);
      if (feedback->object_exists && config.map.weight > 0) {
        map = MapView{camera.undistorted().reduced(feedback->reduction),
                      feedback->predicted_depth_mm, feedback->body};
        T_WM = p.T_WC;
        T_MO = p.T_CO;
      }
    }
  }
}

void RigidFusionSegmenter::Impl::learnSteps(const PastFrame& before, PastFrame& now) {
  const bool newest = &now == &past.back();
  if (priors.learnCameraStep(before, now) && newest) last_motion.camera = now.camera.T;
  if (priors.learnObjectStep(before, now) && newest) objectStep() = now.object.T;
}

const PastFrame* RigidFusionSegmenter::Impl::reference(const PastFrame& now) const {
  const PastFrame* best = nullptr;
  const PastFrame* anchored = nullptr;  // of poses that are off nothing good can be chained
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

void RigidFusionSegmenter::Impl::coast(PastFrame& now, SegmentationResult& out) const {
  const PastFrame& last = past.back();
  now.T_WC = last.T_WC * now.camera.T;
  const SE3 T_WO = last.T_WC * last.T_CO * (priors.objectSeen() ? now.object.T : SE3());
  now.T_CO =
      priors.kinematicObject() ? now.object.T.inverse() * last.T_CO : now.T_WC.inverse() * T_WO;
  out.camera.health = now.camera.measured ? Health::kPriorOnly : Health::kLost;
  out.camera.covariance = now.camera.covariance;
  out.object.health =
      priors.objectSeen() && now.object.measured ? Health::kPriorOnly : Health::kLost;
  out.object.covariance = now.object.covariance;
  out.hypothesis = "no-image";
  now.memory = last.memory;
  now.moved_frames = last.moved_frames;
}

JointLevel RigidFusionSegmenter::Impl::levelOf(const PastFrame& ref, const PastFrame& now,
                                               const Clusters& clusters, std::size_t level) {
  return {&ref.levels[level], &now.levels[level], &clusters.label[level]};
}

DecisionInput RigidFusionSegmenter::Impl::decisionInput(const PastFrame& ref, const PastFrame& now,
                                                        const Clusters& clusters) const {
  const PastFrame& last = past.back();
  DecisionInput input;
  input.level = levelOf(ref, now, clusters, kCoarseLevel);
  input.window_prior = priors.window(past, ref, now);
  input.step_prior = priors.step(ref, last, now);
  input.adjacency = &clusters.adjacency;
  input.camera_measured = now.camera.measured;
  input.camera_tells = priors.cameraTells(now);
  input.body_seen = last.body_seen;
  input.body_moved = last.object_moves;
  input.moved_frames = last.moved_frames;
  input.turned_frames = last.turned_frames;
  const SE3 chain_s = ref.T_WC.inverse() * last.T_WC;
  const SE3 chain_d = ref.T_CO * last.T_CO.inverse();
  input.continued.T_s = input.step_prior.T_s;
  input.continued.T_d = input.step_prior.expectedObject(input.continued.T_s);
  if (!priors.objectSeen() && last_motion.object) {
    input.continued.T_d = chain_d * last.T_CO * last_motion.object->inverse() *
                          last.T_CO.inverse() * chain_s.inverse() * input.continued.T_s;
  }
  input.warped =
      warpScores(last.memory, maskCamera(), now.levels[kCoarseLevel], clusters.label[kCoarseLevel],
                 clusters.centres.size(), chain_s.inverse() * input.continued.T_s,
                 chain_d.inverse() * input.continued.T_d);
  input.continued.gamma = input.warped.target;
  // Where a prior can decide, a map that it has not confirmed yet might only confirm a wrong start.
  const bool no_prior = !priors.objectSeen() && !now.camera.measured;
  if (map && (no_prior || priors.mature())) {
    input.map = &*map;
    input.T_MA_static = T_WM.inverse() * ref.T_WC;
    input.T_MA_object = T_MO * ref.T_CO.inverse();
  }
  return input;
}

JointFit RigidFusionSegmenter::Impl::refine(const PastFrame& ref, const PastFrame& now,
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

void RigidFusionSegmenter::Impl::takeMotions(const JointFit& fit, const PastFrame& ref,
                                             PastFrame& now, SegmentationResult& out) const {
  const PastFrame& last = past.back();
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
  judge(out.object, priors.objectSeen() && now.object.measured);
}

/// The poses after a turn. Since the reference the world has been what was called the body, and the
/// other way round.
void RigidFusionSegmenter::Impl::turnMotions(const JointState& state, const PastFrame& ref,
                                             PastFrame& now) const {
  const PastFrame& last = past.back();
  const SE3 chain_s = ref.T_WC.inverse() * last.T_WC;
  const SE3 chain_d = ref.T_CO * last.T_CO.inverse();
  now.T_WC = last.T_WC * chain_d.inverse() * state.T_s;
  now.T_CO = state.T_d.inverse() * chain_s * last.T_CO;
}

void RigidFusionSegmenter::Impl::takeMask(const JointFit& fit, const PastFrame& ref,
                                          const Clusters& clusters, const JointPrior& prior,
                                          PastFrame& now, SegmentationResult& out) const {
  const PastFrame& last = past.back();
  out.gamma = fit.state.gamma;
  out.label = clusters.label[kMaskLevel];
  out.score = scoreImage(out.label, out.gamma);
  out.dynamic_share = dynamicShare(out.label, out.gamma);
  if (fit.state.one_body) {
    // What is known while everything rests: the last two-body scores, moved with the world.
    const SE3 step = last.T_WC.inverse() * now.T_WC;
    const ScorePrior kept =
        warpScores(last.memory, maskCamera(), now.levels[kCoarseLevel],
                   clusters.label[kCoarseLevel], clusters.centres.size(), step, step);
    now.memory = scoreImage(out.label, kept.target);
    // Without an object prior a mask that lapses is rather a false start than a pause.
    if (priors.objectSeen() && settling.inDoubt()) {
      out.gamma = kept.target;
      out.score = now.memory;
      out.dynamic_share = dynamicShare(out.label, out.gamma);
    }
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

Solution RigidFusionSegmenter::Impl::solve(const PastFrame& ref, const PastFrame& now,
                                           const Clusters& clusters, const DecisionInput& input,
                                           StageTimes& times) const {
  StageClock clock;
  Solution out;
  out.window_prior = input.window_prior;
  out.decision = decide(input, config.joint, config.decision, config.terms, config.map);
  clock.lap("decide", times);
  out.fit = refine(ref, now, clusters, input, out.decision);
  clock.lap("refine", times);
  return out;
}

/// For a frame that no reading explains: the camera prior may have led all of them astray. Once
/// more from the estimates alone, as if the camera went on as before; kept where it explains the
/// picture better, and the prior's increment is forgotten with it.
void RigidFusionSegmenter::Impl::distrustPrior(const PastFrame& ref, const Clusters& clusters,
                                               PastFrame& now, Solution& solution,
                                               StageTimes& times) const {
  const Increment given = now.camera;
  now.camera = priors.unmeasured(last_motion.camera);
  DecisionInput input = decisionInput(ref, now, clusters);
  input.window_prior = input.step_prior;
  Solution other = solve(ref, now, clusters, input, times);
  const JointLevel fine = levelOf(ref, now, clusters, kFineLevel);
  const double c = std::min(solution.fit.state.c, other.fit.state.c);
  const bool better = imageEnergy(fine, other.fit, other.window_prior, config.joint, c) <
                      imageEnergy(fine, solution.fit, solution.window_prior, config.joint, c);
  if (better) {
    solution = std::move(other);
  } else {
    now.camera = given;
  }
}

/// A rest ends a reading, but not one that has lasted: the next start is of the same body.
int RigidFusionSegmenter::Impl::framesMoved(const PastFrame& last, const Decision& decision) const {
  if (decision.turned) return 1;
  if (!decision.fit.state.one_body) return last.moved_frames + 1;
  return last.moved_frames >= config.decision.lasted_frames ? last.moved_frames : 0;
}

void RigidFusionSegmenter::Impl::estimate(const PastFrame& ref, const Clusters& clusters,
                                          PastFrame& now, SegmentationResult& out) {
  Solution found = solve(ref, now, clusters, decisionInput(ref, now, clusters), out.stage_ms);
  if (usual.exceededBy(found.fit.rms_s) && now.camera.measured) {
    distrustPrior(ref, clusters, now, found, out.stage_ms);
  }
  usual.learn(found.fit.rms_s);
  StageClock clock;
  out.hypothesis = found.decision.name;
  out.object_moving = !found.fit.state.one_body;
  now.body_seen = found.decision.body_seen;
  now.turned_frames = found.decision.turned_frames;
  now.moved_frames = framesMoved(past.back(), found.decision);
  settling.note(out.object_moving);
  takeMotions(found.fit, ref, now, out);
  out.turned = found.decision.turned;
  if (out.turned) turnMotions(found.fit.state, ref, now);
  takeMask(found.fit, ref, clusters, found.window_prior, now, out);
  clock.lap("mask", out.stage_ms);
}

void RigidFusionSegmenter::Impl::finish(PastFrame& now, SegmentationResult& out) {
  const PastFrame& last = past.back();
  out.camera.T_AB = last.T_WC.inverse() * now.T_WC;
  out.object.T_AB = last.T_CO * now.T_CO.inverse();
  now.object_moves = out.object_moving;
  last_motion.camera = out.camera.T_AB;
  last_motion.object_motion = out.object.T_AB;
  const SE3 T_WO_a = last.T_WC * last.T_CO;
  last_motion.object = T_WO_a.inverse() * now.T_WC * now.T_CO;
  if (!now.camera.measured && out.camera.health == Health::kTracked) {
    // No other witness: the estimate itself is what later windows may lean on.
    now.camera.T = out.camera.T_AB;
    now.camera.covariance = covarianceOf({config.estimate_spread_m, config.estimate_spread_rad});
  }
  // Of an object that is not seen the motion over the window is what was expected. Taken for one
  // step it would be expected again, and grow from frame to frame.
  const bool expected = !now.object.measured && out.object.health != Health::kTracked;
  if (expected && priors.objectSeen()) objectStep() = now.object.T;
}

SegmentationResult RigidFusionSegmenter::Impl::process(PreparedFrame frame,
                                                       const MotionPrior& prior,
                                                       const ModelState* feedback) {
  SegmentationResult out;
  out.stage_ms = std::move(frame.stage_ms);
  applyFeedback(feedback);
  PastFrame now;
  now.utime = frame.utime;
  now.usable = frame.usable;
  now.levels = std::move(frame.terms);
  now.mask_depth = std::move(frame.pyramid[kMaskLevel].depth);
  const Clusters& clusters = frame.clusters;

  out.utime = frame.utime;
  out.seq = frame.seq;
  out.reduction = config.reduction;
  out.label = clusters.label[kMaskLevel];
  out.gamma.assign(clusters.centres.size(), 1.0F);
  out.score = scoreImage(out.label, out.gamma);
  if (past.empty()) {
    out.first = true;
    priors.start(prior, now);
    now.memory = out.score;
    out.hypothesis = "first";
    out.camera.health = out.object.health = now.usable ? Health::kTracked : Health::kLost;
    out.utime_a = frame.utime;
  } else {
    out.utime_a = past.back().utime;
    priors.accept(prior, last_motion, now);
    const PastFrame* ref = now.usable ? reference(now) : nullptr;
    if (ref != nullptr) {
      estimate(*ref, clusters, now, out);
    } else {
      coast(now, out);
    }
    finish(now, out);
  }
  out.has_prior_T_WC = prior.camera != PriorState::kMissing;
  if (out.has_prior_T_WC) out.prior_T_WC = prior.T_WCb;
  out.world_told = priors.objectSeen() || priors.cameraTells(now);
  swap.observe(out);
  out.has_T_CO = priors.objectSeen();
  if (out.has_T_CO) out.T_CO = now.T_CO;
  if (out.turned) past.clear();  // chains of the other reading lead nowhere
  now.mask_depth = {};
  past.push_back(std::move(now));
  while (past.size() > static_cast<std::size_t>(config.window_frames)) past.pop_front();
  return out;
}

RigidFusionSegmenter::RigidFusionSegmenter(const SegmentationConfig& config, const Camera& camera)
    : impl_(std::make_unique<Impl>(config, camera)) {}
RigidFusionSegmenter::~RigidFusionSegmenter() = default;
RigidFusionSegmenter::RigidFusionSegmenter(RigidFusionSegmenter&&) noexcept = default;

PreparedFrame RigidFusionSegmenter::prepare(const RgbdFrame& frame) const {
  return impl_->preparer.prepare(frame);
}

SegmentationResult RigidFusionSegmenter::process(PreparedFrame frame, const MotionPrior& prior,
                                                 const ModelState* feedback) {
  return impl_->process(std::move(frame), prior, feedback);
}

void RigidFusionSegmenter::reset() { impl_ = std::make_unique<Impl>(impl_->config, impl_->camera); }

}  // namespace rf
