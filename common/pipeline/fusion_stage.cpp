// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/fusion_stage.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/undistort.hpp"
#include "mapping/body_model.hpp"
#include "mapping/object_life.hpp"
#include "mapping/tracker.hpp"
#include "pipeline/camera_tracking.hpp"
#include "pipeline/fusion_input.hpp"
#include "pipeline/fusion_state.hpp"
#include "pipeline/loop_closing.hpp"
#include "pipeline/map_update.hpp"
#include "pipeline/object_following.hpp"
#include "pipeline/pose_uncertainty.hpp"
#include "pipeline/turned_reading.hpp"
#include "values/stage_clock.hpp"

namespace rf {
namespace {

constexpr int kFeedbackReduction = 4;

// What the next frame's steps need to know of this one.
void remember(const SegmentationResult& s, const SE3& T_WC_before, FusionState& m) {
  const double dt = static_cast<double>(s.utime - m.last_utime) * 1e-6;
  if (m.started && dt > 0 && m.rejected_frames == 0) {
    m.velocity = (T_WC_before.inverse() * m.camera_pose.T_W).log() / dt;
  }
  m.started = true;
  m.last_utime = s.utime;
  m.last_prior = s.has_prior_T_WC ? std::optional<SE3>(s.prior_T_WC) : std::nullopt;
}

// The model state without its times.
ModelState report(const RgbdFrame& frame, const Camera& input_camera, const FusionState& m) {
  ModelState state;
  state.utime = frame.utime;
  state.seq = frame.seq;
  state.camera = m.swapped.widened(m.camera_pose);
  state.object = m.swapped.widened(m.object_pose);
  state.object_exists = m.life.phase != ObjectPhase::kNone;
  state.object_resting = m.life.phase == ObjectPhase::kResting;
  state.static_surfels = m.world.map.size();
  state.object_surfels = m.object.map.size();
  state.reduction = kFeedbackReduction;
  FeedbackPlanes planes =
      feedbackPlanes(m.world.prediction, state.object_exists ? &m.object.prediction : nullptr,
                     input_camera, m.config.reduction, kFeedbackReduction, m.stable);
  state.predicted_depth_mm = std::move(planes.depth_mm);
  state.body = std::move(planes.body);
  return state;
}

}  // namespace

struct FusionStage::Impl {
  Impl(const FusionConfig& config, const Camera& cam)
      : given(config),
        input_camera(cam),
        undistorter(cam),
        state(config, cam.undistorted().reduced(config.reduction)) {}

  FusionConfig given;
  Camera input_camera;
  Undistorter undistorter;
  FusionState state;
};

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
  FusionState& m = impl_->state;
  checkFusionInput(frame, segmentation, impl_->input_camera);
  StageTimes times;
  StageClock clock;
  const FusionInput f = prepareFusionInput(frame, segmentation, impl_->undistorter, m.config);
  ++m.time;
  clock.lap("prep", times);
  turnReading(f, segmentation, m);
  const SE3 before = m.camera_pose.T_W;
  MayFuse may;
  may.world = trackCamera(f, segmentation, m);
  clock.lap("track_camera", times);
  const ObjectAction action = advance(m.life, signsOf(segmentation, m), m.config.object);
  may.object = followObject(f, segmentation, action, m);
  notePlace(action, m);
  clock.lap("track_object", times);
  predictModels(action, m);
  if (may.world && closeLoop(f, m)) may.world = false;
  if (action == ObjectAction::kRest) judgeRestingObject(f, m);
  settleUncertainty(f, segmentation, action, may, m);
  ReadFrame read{m.camera_pose.T_W, std::nullopt, action == ObjectAction::kBirth};
  if (m.life.phase != ObjectPhase::kNone) read.T_WO = m.T_WO;
  m.swapped.observe(segmentation, read);
  clock.lap("predict", times);
  fuseModels(f, action, may, m);
  clock.lap("fuse", times);
  cleanModels(f, action, may, m);
  clock.lap("clean", times);
  remember(segmentation, before, m);
  ModelState state = report(frame, impl_->input_camera, m);
  state.stage_ms = std::move(times);
  return state;
}

std::vector<SurfelPoint> FusionStage::surfels(std::uint8_t body) const {
  const FusionState& m = impl_->state;
  if (body == kBodyStatic) return exportSurfels(m.world, m.T_WF, m.config.surfels);
  if (body == kBodyObject) return exportSurfels(m.object, SE3(), m.config.surfels);
  return {};
}

void FusionStage::reset() { impl_ = std::make_unique<Impl>(impl_->given, impl_->input_camera); }

}  // namespace rf
