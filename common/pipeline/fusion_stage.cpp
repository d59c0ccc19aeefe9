// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/fusion_stage.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/undistort.hpp"
#include "mapping/body_model.hpp"
#include "mapping/object_life.hpp"
#include "mapping/tracker.hpp"
#include "pipeline/fusion_input.hpp"

namespace rf {
namespace {

constexpr int kFeedbackReduction = 4;
constexpr double kMaxBridgeSeconds = 1.0;  // constant velocity is not believed for longer
constexpr double kCarveFactor =
    100.0;                            // at birth the object's surfels leave the static map at once
constexpr double kYoungFactor = 3.0;  // ... and soon while the model is young
constexpr int kYoungFrames = 10;
constexpr double kScarceWorld = 0.15;  // share of the image
constexpr double kSearchInflation = 10.0;
constexpr double kReferencePixels = 320.0 * 240.0;  // thresholds in pixels are given for this image

class StageClock {
 public:
  explicit StageClock(StageTimes& times) : times_(times) {}
  void lap(const char* name) {
    const auto now = std::chrono::steady_clock::now();
    times_.emplace_back(name, std::chrono::duration<double, std::milli>(now - last_).count());
    last_ = now;
  }

 private:
  StageTimes& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

Health worse(Health a, Health b) {
  const auto known = [](Health h) { return h == Health::kInvalid ? Health::kDegraded : h; };
  return std::max(known(a), known(b));
}

// The segmentation's covariance as a start for tracking: inflated, never tighter than the floor.
Mat6 startCovariance(const Mat6& cov, const TrackingConfig& c, double extra) {
  Mat6 out = Mat6::Zero();
  const double v = c.start_floor_m * c.start_floor_m * extra;
  const double w = c.start_floor_rad * c.start_floor_rad * extra;
  out.diagonal() << v, v, v, w, w, w;
  constexpr double kBound = 1.0;  // beyond it (or not a covariance) nothing is known: use the bound
  const bool usable =
      cov.allFinite() && cov.diagonal().minCoeff() >= 0 && cov.cwiseAbs().maxCoeff() < kBound;
  if (usable) return out + c.start_inflation * 0.5 * (cov + cov.transpose());
  return out + Mat6::Identity() * 0.01;
}

Image<float> everywhere(const Image<float>& depth) {
  Image<float> out(depth.width(), depth.height());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = depth[i] > 0 ? 1.0F : 0.0F;
  return out;
}

// Looking for the model again after frames that did not fit: farther, but only convinced by more.
FusionConfig wideSearch(FusionConfig c) {
  TrackingConfig& t = c.tracking;
  t.coarse_distance = 2.5;
  t.iterations_coarse = 20;
  t.iterations_fine = 10;
  t.max_shift_m *= 3.0;
  t.max_turn_rad *= 2.0;
  t.sure_inliers = 1.0;  // nothing is sure here
  t.max_rms_sigma *= 0.7;
  return c;
}

}  // namespace

struct FusionStage::Impl {
  Impl(const FusionConfig& c, const Camera& cam)
      : config(c),
        input_camera(cam),
        undistorter(cam),
        camera(cam.undistorted().reduced(c.reduction)),
        stable(logit(c.surfels.stable_confidence)),
        world(c, camera),
        object(c, camera) {}

  FusionConfig config;
  Camera input_camera;
  Undistorter undistorter;
  Camera camera;  // of the maps
  float stable;

  BodyModel world;
  BodyModel object;
  SE3 T_WF;  // the static map's frame is the first camera
  SE3 T_WO, T_WO_birth;
  ObjectLife life;

  bool started = false;
  std::int32_t time = 0;
  std::int64_t last_utime = 0;
  std::optional<SE3> last_prior;
  int rejected_frames = 0;       // in a row, by the camera's tracking
  Vec6 velocity = Vec6::Zero();  // of the camera, per second
  BodyPose camera_pose, object_pose;

  void trackCamera(const FusionInput& f, const SegmentationResult& s, bool& fuse);
  void followObject(const FusionInput& f, const SegmentationResult& s, ObjectAction action,
                    bool& fuse);
  void judgeRestingObject(const FusionInput& f);
  void predictAll(ObjectAction action);
  void fuseAll(const FusionInput& f, ObjectAction action, bool fuse_world, bool fuse_object);
  void cleanAll(const FusionInput& f, ObjectAction action, bool fuse_world, bool fuse_object);
  bool bridged(const SegmentationResult& s) const {
    return started && (s.first || s.utime_a != last_utime);
  }
  double secondsSince(std::int64_t utime) const {
    return std::clamp(static_cast<double>(utime - last_utime) * 1e-6, 0.0, kMaxBridgeSeconds);
  }
  SE3 step(const SegmentationResult& s) const;
  TrackResult trackElsewhere(const FusionInput& f, const SegmentationResult& s, const SE3& start,
                             const std::vector<TrackReference>& reference) const;
  double minObjectPixels() const {
    return config.tracking.min_object_pixels * static_cast<double>(camera.width * camera.height) /
           kReferencePixels;
  }
};

// Camera motion since the last processed frame, before refinement. Where segmentation's frame A is
// not that frame (loss, restart), increments of one and the same prior bridge the gap, else
// constant velocity.
SE3 FusionStage::Impl::step(const SegmentationResult& s) const {
  if (!bridged(s)) return s.camera.T_AB;
  if (s.has_prior_T_WC && last_prior) return last_prior->inverse() * s.prior_T_WC;
  if (s.first) return SE3::exp(velocity * secondsSince(s.utime));
  return SE3::exp(velocity * secondsSince(s.utime_a)) * s.camera.T_AB;
}

// Starts beside the segmentation's, which did not lead to the model: the camera's own velocity, the
// prior's increment, and after more than one such frame a wide search with every pixel (the mask
// may be what is wrong, and the map holds the static world alone).
TrackResult FusionStage::Impl::trackElsewhere(const FusionInput& f, const SegmentationResult& s,
                                              const SE3& start,
                                              const std::vector<TrackReference>& reference) const {
  const TrackingConfig& t = config.tracking;
  const double min_inliers = t.min_inliers * static_cast<double>(camera.width * camera.height);
  const Mat6 loose = startCovariance(Mat6::Zero(), t, 100.0);
  const WeightPyramid weights = weightPyramid(f.weights.world.own, t.levels);
  std::vector<SE3> starts = {SE3::exp(velocity * secondsSince(s.utime))};
  if (s.has_prior_T_WC && last_prior) starts.push_back(last_prior->inverse() * s.prior_T_WC);
  const WeightPyramid all = weightPyramid(everywhere(f.maps.depth), t.levels);
  TrackResult best;
  for (const SE3& other : starts) {
    for (const WeightPyramid* w : {&weights, &all}) {
      TrackResult r =
          alignToModel(reference, f.pyramid, *w, other, loose, 5.0 * min_inliers, config);
      if (r.accepted && r.inliers > best.inliers) best = std::move(r);
    }
  }
  if (best.accepted || rejected_frames == 0) return best;
  starts.push_back(start);
  for (const SE3& other : starts) {
    TrackResult r = alignToModel(reference, f.pyramid, all, other, loose * kSearchInflation,
                                 5.0 * min_inliers, wideSearch(config));
    if (r.accepted && r.inliers > best.inliers) best = std::move(r);
  }
  return best;
}

void FusionStage::Impl::trackCamera(const FusionInput& f, const SegmentationResult& s, bool& fuse) {
  if (!started) {
    T_WF = s.has_prior_T_WC ? s.prior_T_WC : SE3();
    world.T_FC = SE3();
    camera_pose = {};
    camera_pose.T_W = T_WF;
    camera_pose.covariance = Mat6::Identity() * 1e-12;
    camera_pose.health = Health::kTracked;
    fuse = true;
    return;
  }
  const bool gap = bridged(s);
  const SE3 start = step(s);
  const Mat6 start_cov = startCovariance(s.camera.covariance, config.tracking, gap ? 100.0 : 1.0);
  const double pixels = static_cast<double>(camera.width * camera.height);
  // An object at rest is as good a landmark as the world, but it may start to move unnoticed: it
  // only helps where the world alone is too little.
  const bool scarce =
      static_cast<double>(stablePixels(world.prediction, stable)) < kScarceWorld * pixels;
  const bool help = life.phase == ObjectPhase::kResting && scarce;
  const std::vector<TrackReference> reference =
      makeReference(help ? mergeNearest(world.prediction, object.prediction) : world.prediction,
                    config.tracking.levels, stable);
  const double min_inliers = config.tracking.min_inliers * pixels;
  TrackResult r =
      alignToModel(reference, f.pyramid, weightPyramid(f.weights.world.own, config.tracking.levels),
                   start, start_cov, min_inliers, config);
  const TrackResult again = r.accepted ? TrackResult{} : trackElsewhere(f, s, start, reference);
  if (again.accepted) r = again;
  // Without a prior and without the model's support a leap is not believed: rather stay in motion.
  const SE3 steady = SE3::exp(velocity * secondsSince(s.utime));
  const bool leap = !r.accepted && !s.has_prior_T_WC &&
                    (steady.inverse() * start).t.norm() > config.tracking.max_shift_m;
  if (leap) r.T_PC = steady;
  rejected_frames = r.accepted ? 0 : rejected_frames + 1;
  world.T_FC = world.T_FC * r.T_PC;
  camera_pose.T_W = T_WF * world.T_FC;
  camera_pose.inliers = r.inliers;
  camera_pose.rms_residual = r.rms_m;
  if (r.accepted) {
    camera_pose.covariance = r.covariance;
    const bool weak = gap || r.inliers < 5.0 * min_inliers;
    camera_pose.health = weak ? Health::kDegraded : Health::kTracked;
  } else {
    const Mat6 back = r.T_PC.inverse().adjoint();
    camera_pose.covariance = back * camera_pose.covariance * back.transpose() + start_cov;
    camera_pose.health = worse(worse(s.camera.health, Health::kDegraded),
                               gap ? Health::kPriorOnly : Health::kDegraded);
    if (leap) camera_pose.health = Health::kLost;
  }
  // A pose that contradicts the model must not be fused; one that has nothing to be compared with
  // may.
  fuse = r.accepted || (r.inlier_share == 0 && camera_pose.health < Health::kPriorOnly);
}

void FusionStage::Impl::followObject(const FusionInput& f, const SegmentationResult& s,
                                     ObjectAction action, bool& fuse) {
  fuse = false;
  if (action == ObjectAction::kForget) {
    object = BodyModel(config, camera);
    object_pose = {};
  }
  if (action == ObjectAction::kNothing || action == ObjectAction::kForget) {
    object_pose.health = Health::kLost;
    return;
  }
  const SE3 T_WC = camera_pose.T_W;
  if (action == ObjectAction::kRest) {
    object.T_FC = T_WO.inverse() * T_WC;
    return;
  }
  Mat6 cov_OC = Mat6::Zero();  // right perturbation of T_OC
  if (action == ObjectAction::kBirth) {
    object = BodyModel(config, camera);
    object.T_FC = s.has_T_CO ? s.T_CO.inverse() : SE3();
    T_WO_birth = T_WC * object.T_FC.inverse();
    object_pose = {};
    object_pose.health = worse(s.object.health, camera_pose.health);
    cov_OC = s.object.covariance;
    fuse = true;
  } else {
    const bool gap = bridged(s);
    const SE3 start = gap ? object.T_FC.inverse() * T_WO.inverse() * T_WC : s.object.T_AB;
    const Mat6 start_cov = startCovariance(s.object.covariance, config.tracking, gap ? 100.0 : 1.0);
    TrackResult r;
    r.T_PC = start;
    r.covariance = start_cov;
    const bool enough =
        static_cast<double>(stablePixels(object.prediction, stable)) >= minObjectPixels();
    if (enough) {
      r = alignToModel(makeReference(object.prediction, config.tracking.levels, stable), f.pyramid,
                       weightPyramid(f.weights.object.own, config.tracking.levels), start,
                       start_cov, 0.3 * minObjectPixels(), config);
    }
    object.T_FC = object.T_FC * r.T_PC;
    object_pose.inliers = r.inliers;
    object_pose.rms_residual = r.rms_m;
    object_pose.health =
        r.accepted && !gap ? Health::kTracked : worse(s.object.health, Health::kDegraded);
    cov_OC = r.covariance;
    fuse = r.accepted || !enough || r.inlier_share == 0;
  }
  T_WO = T_WC * object.T_FC.inverse();
  object_pose.T_W = T_WO;
  const Mat6 ad = object.T_FC.adjoint();
  object_pose.covariance = ad * (cov_OC + camera_pose.covariance) * ad.transpose();
}

// While it rests the object's pose is an assumption; the image may confirm or refute it.
void FusionStage::Impl::judgeRestingObject(const FusionInput& f) {
  const Agreement a = agreement(object.prediction, f.maps, config);
  const double seen = a.on_surface + a.through;
  object_pose.inliers = a.on_surface;
  object_pose.rms_residual = 0;
  if (seen < 0.3 * minObjectPixels()) {
    object_pose.health = Health::kPriorOnly;
  } else if (a.on_surface > 0.5 * seen) {
    object_pose.health = worse(Health::kTracked, camera_pose.health);
  } else {
    object_pose.health = a.on_surface > 0.2 * seen ? Health::kDegraded : Health::kLost;
  }
}

void FusionStage::Impl::predictAll(ObjectAction action) {
  const PredictOptions options = PredictOptions::from(config);
  world.predictor.predict(world.map, world.T_FC, camera, options, world.prediction);
  if (action == ObjectAction::kMove || action == ObjectAction::kRest) {
    object.predictor.predict(object.map, object.T_FC, camera, options, object.prediction);
  }
}

void FusionStage::Impl::fuseAll(const FusionInput& f, ObjectAction action, bool fuse_world,
                                bool fuse_object) {
  const bool exists = life.phase != ObjectPhase::kNone;
  const Image<std::uint8_t> none;
  const Image<std::uint8_t> object_explains =
      exists ? explainedBy(object.prediction, f.maps, config) : none;
  const Image<std::uint8_t> world_explains =
      action == ObjectAction::kMove ? explainedBy(world.prediction, f.maps, config) : none;
  const bool first = !started;
  if (fuse_world) {
    FuseInput in{
        f.maps, f.weights.world, f.weights.object.interior, object_explains, world.T_FC, time,
        first};
    if (action == ObjectAction::kBirth) in.miss = kCarveFactor;
    if (action == ObjectAction::kMove && life.moving_frames <= kYoungFrames) in.miss = kYoungFactor;
    world.cleaner.noteGrowth(fuseFrame(in, config, world.map, world.prediction).grown, time);
  }
  if (fuse_object) {
    const FuseInput in{f.maps,
                       f.weights.object,
                       f.weights.world.interior,
                       world_explains,
                       object.T_FC,
                       time,
                       action == ObjectAction::kBirth};
    object.cleaner.noteGrowth(fuseFrame(in, config, object.map, object.prediction).grown, time);
  }
}

void FusionStage::Impl::cleanAll(const FusionInput& f, ObjectAction action, bool fuse_world,
                                 bool fuse_object) {
  if (fuse_world) {
    world.cleaner.clean(f.maps, world.T_FC, time, config, world.prediction.blocks, world.map);
  }
  if (fuse_object && action == ObjectAction::kMove) {
    object.cleaner.clean(f.maps, object.T_FC, time, config, object.prediction.blocks, object.map);
  }
}

FusionStage::FusionStage(const FusionConfig& config, const Camera& camera) {
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  if (config.reduction < 1 || camera.width / config.reduction < 16 ||
      camera.height / config.reduction < 16) {
    throw std::invalid_argument("fusion.reduction = " + std::to_string(config.reduction) +
                                ": must be >= 1 and leave at least 16x16 pixels");
  }
  kernelByName(config.tracking.kernel);
  impl_ = std::make_unique<Impl>(config, camera);
}

FusionStage::~FusionStage() = default;

ModelState FusionStage::process(const RgbdFrame& frame, const SegmentationResult& segmentation) {
  Impl& m = *impl_;
  checkFusionInput(frame, segmentation, m.input_camera);
  ModelState state;
  StageClock clock(state.stage_ms);
  const FusionInput f = prepareFusionInput(frame, segmentation, m.undistorter, m.config);
  ++m.time;
  clock.lap("prep");
  bool fuse_world = false, fuse_object = false;
  const SE3 before = m.camera_pose.T_W;
  m.trackCamera(f, segmentation, fuse_world);
  clock.lap("track_camera");
  const double travelled = (m.T_WO.t - m.T_WO_birth.t).norm();
  const ObjectAction action = advance(m.life, segmentation.object_moving,
                                      segmentation.dynamic_share, travelled, m.config.object);
  m.followObject(f, segmentation, action, fuse_object);
  clock.lap("track_object");
  m.predictAll(action);
  if (action == ObjectAction::kRest) m.judgeRestingObject(f);
  clock.lap("predict");
  m.fuseAll(f, action, fuse_world, fuse_object);
  clock.lap("fuse");
  m.cleanAll(f, action, fuse_world, fuse_object);
  clock.lap("clean");

  const double dt = static_cast<double>(frame.utime - m.last_utime) * 1e-6;
  if (m.started && dt > 0 && m.rejected_frames == 0) {
    m.velocity = (before.inverse() * m.camera_pose.T_W).log() / dt;
  }
  m.started = true;
  m.last_utime = frame.utime;
  m.last_prior =
      segmentation.has_prior_T_WC ? std::optional<SE3>(segmentation.prior_T_WC) : std::nullopt;

  state.utime = frame.utime;
  state.seq = frame.seq;
  state.camera = m.camera_pose;
  state.object = m.object_pose;
  state.object_exists = m.life.phase != ObjectPhase::kNone;
  state.object_resting = m.life.phase == ObjectPhase::kResting;
  state.static_surfels = m.world.map.size();
  state.object_surfels = m.object.map.size();
  state.reduction = kFeedbackReduction;
  FeedbackPlanes planes =
      feedbackPlanes(m.world.prediction, state.object_exists ? &m.object.prediction : nullptr,
                     m.input_camera, m.config.reduction, kFeedbackReduction, m.stable);
  state.predicted_depth_mm = std::move(planes.depth_mm);
  state.body = std::move(planes.body);
  return state;
}

std::vector<SurfelPoint> FusionStage::surfels(std::uint8_t body) const {
  const Impl& m = *impl_;
  if (body == kBodyStatic) return exportSurfels(m.world.map, m.T_WF, m.config.surfels);
  if (body == kBodyObject) return exportSurfels(m.object.map, SE3(), m.config.surfels);
  return {};
}

void FusionStage::reset() { impl_ = std::make_unique<Impl>(impl_->config, impl_->input_camera); }

}  // namespace rf
