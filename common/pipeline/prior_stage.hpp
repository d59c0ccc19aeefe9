// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "priors/pose_buffer.hpp"
#include "priors/prior_config.hpp"
#include "priors/robot_prior.hpp"
#include "values/motion_prior.hpp"
#include "values/stamped_pose.hpp"

namespace rf {

/// Motion priors from pose sources or a robot as a plain object (paper section III): values in,
/// values out. Missing or late data is flagged, never replaced by identity. Not thread-safe.
///
/// Camera source: T_WB of a body B that carries the camera; with the extrinsic T_BC of the
/// configuration T_WC = T_WB T_BC, and the drift of B is carried into the camera frame.
/// Object source: T_WO in some world frame of its own, or T_CO, as `object_frame` says.
/// A robot (URDF, odometry, joints, grasps) gives what no such source gives, and its own shapes.
class PriorStage {
 public:
  /// Why the last prior was not valid; empty where it was, or where there is no source.
  struct Status {
    std::string camera_reason;
    std::string object_reason;
    std::int64_t camera_missing = 0;  ///< priors so far
    std::int64_t camera_extrapolated = 0;
    std::int64_t object_missing = 0;
    std::int64_t object_extrapolated = 0;
  };

  /// Throws std::invalid_argument, naming field, value and rule.
  explicit PriorStage(const PriorConfig& config);

  /// Feeds one pose of a live source; from then on the source is taken to exist.
  PoseVerdict addCameraPose(std::int64_t utime, const SE3& T_WB);
  PoseVerdict addObjectPose(std::int64_t utime, const SE3& T_XO);
  /// Feeds a whole file. Poses that the buffer refuses are counted there.
  void addCameraPoses(const Trajectory& T_WB);
  void addObjectPoses(const Trajectory& T_XO);
  /// Says that a live source is expected although no pose has come yet.
  void expectCamera() { has_camera_ = true; }
  void expectObject() { has_object_ = true; }

  /// Takes a robot as the camera's, or the object's, source where no pose source is there; its
  /// shapes go into every prior. A robot that holds nothing gives no object prior; that is no
  /// fault.
  void useRobot(RobotPrior robot, bool gives_camera, bool gives_object);
  /// The robot, to feed it while it lives; nullptr when there is none.
  RobotPrior* robot() { return robot_ ? &*robot_ : nullptr; }

  /// True when every source has a pose at or after `utime`: waiting longer brings nothing new.
  bool covers(std::int64_t utime) const;

  /// The prior of (frame of the last call, this frame); the first call gives utime_a = utime_b and
  /// identity increments. State per body: kValid, kExtrapolated when either end is, kMissing when
  /// either end is. Throws std::invalid_argument when `utime` is not later than that of the last
  /// call; nothing changes then.
  MotionPrior process(std::int64_t utime, std::int64_t seq);

  const Status& status() const { return status_; }
  const PoseCounts& cameraCounts() const { return camera_.counts(); }
  const PoseCounts& objectCounts() const { return object_.counts(); }

  /// Forgets the last frame, so that the next call is a first one; keeps the poses.
  void restart() { last_utime_.reset(); }

 private:
  void fillFromRobot(MotionPrior& prior);
  void fillCamera(MotionPrior& prior);
  void fillObject(MotionPrior& prior);
  PoseAt lookUp(const PoseBuffer& buffer, std::int64_t utime) const;

  PriorConfig config_;
  SE3 T_BC_;
  ObjectPriorKind object_kind_ = ObjectPriorKind::kWorldFrame;
  bool has_camera_ = false;
  bool has_object_ = false;
  PoseBuffer camera_;
  PoseBuffer object_;
  std::optional<RobotPrior> robot_;
  bool robot_gives_camera_ = false;
  bool robot_gives_object_ = false;
  std::optional<std::int64_t> last_utime_;
  Status status_;
};

}  // namespace rf
