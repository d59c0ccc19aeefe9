// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "geometry/se3.hpp"
#include "segmentation/joint_prior.hpp"
#include "segmentation/past_frame.hpp"
#include "segmentation/prior_filter.hpp"
#include "segmentation/prior_trust.hpp"
#include "segmentation/segmentation_config.hpp"
#include "values/motion_prior.hpp"

namespace rf {

/// What was estimated for the last frame; empty at the start of a stream.
struct LastMotion {
  std::optional<SE3> camera;         ///< T_CaCb
  std::optional<SE3> object;         ///< T_Oa^-1 T_Ob in the world
  std::optional<SE3> object_motion;  ///< T(xi_d)
};

/// From the prior messages of a stream to the solver's priors (docs/ALGORITHM.md "Priors",
/// "Trust"): what is plausible is taken, with covariances that follow the source's innovations, and
/// chained over a window. Not thread-safe; one per stream.
class PriorIntake {
 public:
  /// Throws std::invalid_argument for an unknown segmentation.object_prior_use.
  explicit PriorIntake(const SegmentationConfig& config);

  /// The stream's first frame: where camera and object start, as far as the sources say.
  void start(const MotionPrior& prior, PastFrame& first);

  /// Sets the sources and the accepted increments of `now`.
  void accept(const MotionPrior& prior, const LastMotion& last, PastFrame& now);

  /// The camera's increment as if its source had said nothing: the last motion goes on.
  Increment unmeasured(const std::optional<SE3>& last_motion) const;

  /// Where no source measured a body's step from `before` to `now`, its model has when both poses
  /// are confirmed: that is what later windows lean on. An expectation taken for a step would be
  /// expected again, over the whole window, and grow from frame to frame. Whether it was learned.
  bool learnCameraStep(const PastFrame& before, PastFrame& now) const;
  bool learnObjectStep(const PastFrame& before, PastFrame& now) const;

  /// What the sources said of a frame whose poses are now known. `before`: the frame before it, or
  /// null.
  void judge(const PastFrame& frame, const PastFrame* before);

  /// Prior of the motions from `ref` to `now` by the increments between. `past`: oldest first.
  JointPrior window(const std::deque<PastFrame>& past, const PastFrame& ref,
                    const PastFrame& now) const;

  /// Prior by the estimates up to the last frame and the increment of `now`.
  JointPrior step(const PastFrame& ref, const PastFrame& last, const PastFrame& now) const;

  /// The camera prior is a witness of which body is the world: it is given in `now` and, without an
  /// object prior, kept its word while only the camera moved.
  bool cameraTells(const PastFrame& now) const {
    return now.camera.measured && (object_seen_ || rightAtRest());
  }
  /// There was an object prior that could be used.
  bool objectSeen() const { return object_seen_; }
  /// The object prior is T_CO by kinematics, independent of the camera's own motion.
  bool kinematicObject() const { return kinematic_object_; }
  /// Object and camera prior have agreed with the models for long enough to give these a vote; a
  /// camera prior that was off at rest is not asked.
  bool mature() const { return agreed_frames_ >= config_.mature_frames; }

 private:
  /// The camera prior kept its word while only the camera moved.
  bool rightAtRest() const { return rest_trust_.translationSquare() <= 1.0; }
  enum class ObjectUse { kAll, kStart, kNone };
  static ObjectUse useOf(const SegmentationConfig& config);
  JointPrior make(const SE3& T_s, const Mat6& cov_s, const PastFrame& at,
                  const Increment& object) const;

  SegmentationConfig config_;
  ObjectUse object_use_;
  PriorFilter camera_filter_, object_filter_;
  PriorTrust camera_trust_, object_trust_;
  PriorTrust rest_trust_;  ///< the camera's, by frames in which only one motion was seen
  bool object_seen_ = false;
  bool object_anchored_;  ///< the object prior is used; its world is the camera's
  bool kinematic_object_ = false;
  int agreed_frames_ = 0;  ///< two bodies, both confirmed, and no contradiction by the camera prior
};

}  // namespace rf
