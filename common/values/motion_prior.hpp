// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/se3.hpp"
#include "values/robot_shape.hpp"

namespace rf {

/// Whether a prior may be used. Missing data is said, never replaced by identity.
enum class PriorState : std::int8_t {
  kMissing = 0,       ///< no source, or no data around the two times
  kValid = 1,         ///< interpolated between samples at both times
  kExtrapolated = 2,  ///< one end lies beyond the newest sample; usable with care
};

/// How the object prior is given.
enum class ObjectPriorKind : std::int8_t {
  kNone = 0,         ///< no object prior
  kCameraFrame = 1,  ///< arm kinematics: T_XO is T_CO, the object in the camera frame
  kWorldFrame = 2,   ///< a pose source in some world frame of its own: T_XO is T_WO there
};

/// Motion prior for the frame pair A (previous) -> B (this frame), paper section III.
/// Only increments are meant to be used: absolute poses of two drifting sources are never composed
/// (except at the very first frame of a sequence, where both are as given).
struct MotionPrior {
  std::int64_t utime_a = 0;  ///< capture time of frame A; equals utime_b for the first frame
  std::int64_t utime_b = 0;  ///< capture time of frame B
  std::int64_t seq = 0;      ///< seq of frame B

  PriorState camera = PriorState::kMissing;
  SE3 T_CaCb;  ///< camera motion: coordinates in C_B -> C_A
  Mat6 camera_cov =
      Mat6::Identity();  ///< of T_CaCb, right perturbation, frame C_B, translation first
  SE3 T_WCb;             ///< the source's own (drifting) absolute pose at B

  ObjectPriorKind object_kind = ObjectPriorKind::kNone;
  PriorState object = PriorState::kMissing;
  SE3 T_XOa;  ///< object pose at A in the frame that object_kind names
  SE3 T_XOb;  ///< object pose at B
  /// World kind: covariance of T_XOa^-1 T_XOb (right perturbation, frame O_B). Camera kind: of the
  /// relative motion T_COa T_COb^-1 (right perturbation, frame C_B).
  Mat6 object_cov = Mat6::Identity();

  /// The robot's own collision shapes in the camera frame of B, at most kMaxRobotShapes; empty
  /// where they are not known.
  std::vector<PosedShape> self;
};

}  // namespace rf
