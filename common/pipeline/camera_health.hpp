// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/tracker.hpp"
#include "pipeline/fusion_state.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Of the least inliers: enough to trust a pose by itself.
inline constexpr double kSureFactor = 5.0;

/// Whether an aligned pose is believed: its picture must be like the map's, where both have
/// contrast. A pose that is in doubt (contradicted by the map, or long without an image) may fit
/// some other place as well: it needs more surface and a better fit, too, as good as is usual here.
bool believed(const TrackResult& track, double min_inliers, const FusionState& state);

/// Puts the pose in doubt, and the object's, whose model has to be found again, when segmentation's
/// motion does not explain the picture by far: the camera may have been carried somewhere else, and
/// what fits there may be another wall. A black picture is not explained either, but says nothing
/// of the motion.
void noteLeap(const SegmentationResult& segmentation, const TrackResult& track, FusionState& state);

/// Whether a step from the last frame is beyond what a camera does: farther from constant velocity
/// than 10 cm, and than 2 g make within `seconds` (20 m/s^2).
bool jumps(const SE3& step, const SE3& steady, double seconds);

/// How the camera came to this frame's pose.
struct CameraEvidence {
  const TrackResult& track;
  const SegmentationResult& segmentation;
  const Mat6& step_covariance;  ///< of the step from the last frame that is taken without the map
  double min_inliers = 0;       ///< that alignment had to have
  bool gap = false;             ///< frames are missing before this one
  bool leap = false;            ///< the step was not believed: constant velocity instead
  bool jump = false;            ///< no camera moves like the step to the aligned pose: jumps()
};

/// Sets inliers, covariance and health of the camera's pose, rejected_frames, contradicted_frames,
/// camera_on_map and blind. The covariance of an aligned pose is given the map (the map's own is
/// added later, see pose_uncertainty.hpp); one that is not aligned grows by the step's, and where
/// the map contradicts it by the range in which it was looked for.
void judgeCamera(const CameraEvidence& evidence, FusionState& state);

}  // namespace rf
