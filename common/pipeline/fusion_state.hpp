// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/se3.hpp"
#include "mapping/body_model.hpp"
#include "mapping/depth_noise.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/object_life.hpp"
#include "mapping/shared_place.hpp"
#include "pipeline/swapped_reading.hpp"
#include "values/model_state.hpp"
#include "values/segmentation_result.hpp"
#include "values/usual_residual.hpp"

namespace rf {

/// What fusion remembers from frame to frame. The steps of a frame (camera_tracking,
/// object_following, map_update) read and change it in that order. Frames: W world of the camera
/// prior, F a body's own frame (of the static map: the first camera), C camera, O object.
struct FusionState {
  FusionState(const FusionConfig& config, const Camera& map_camera);

  FusionConfig config;
  DepthNoise noise;  ///< config.sensor.noise follows it
  Camera camera;     ///< of the maps
  float stable;      ///< log-odds from which a surfel is stable

  BodyModel world;
  BodyModel object;
  SE3 T_WF;                     ///< of the static map
  SE3 T_WO, T_WO_birth;         ///< of the object now and where it was first seen to move
  std::int32_t birth_time = 0;  ///< frame counter then
  ObjectLife life;
  bool object_found = false;      ///< its pose agreed with its model since it was last unseen
  int misfit_frames = 0;          ///< in view and moving, but unlike its model, since it was unseen
  std::int64_t rest_utime = 0;    ///< when it came to rest
  std::vector<RestPlace> places;  ///< where the object stood, oldest first

  bool started = false;
  std::int32_t time = 0;  ///< frame counter, 1 at the first frame
  std::int64_t last_utime = 0;
  std::optional<SE3> last_prior;        ///< the camera prior's pose at the last frame
  int rejected_frames = 0;              ///< in a row, by the camera's tracking
  int contradicted_frames = 0;          ///< of those: surface was in view and did not fit
  UsualResidual usual_residual;         ///< that segmentation leaves of the static world
  double usual_fit = 0;                 ///< running mean of the whitened rms on the map
  double usual_unlikeness = 0;          ///< and of 1 less the likeness of image and map
  double usual_pairs = 0;               ///< running mean of the camera's support by the map, pixels
  int drift_frames = 0;                 ///< in a row, in which surface that came back told of drift
  Vec6 velocity = Vec6::Zero();         ///< of the camera, per second
  Vec6 object_velocity = Vec6::Zero();  ///< of the moving object, in O, per second
  BodyPose camera_pose, object_pose;
  SwappedReading swapped;  ///< of both poses, where nothing says which body is the world

  // Of this frame, for covariance and health (pose_uncertainty, camera_health):
  bool camera_on_map = false;  ///< aligned to the static map: its covariance is given the map
  bool object_on_map = false;  ///< the same of the object's model
  bool blind = false;          ///< the picture shows nothing of what the map shows
  Mat6 covariance_OC = Mat6::Zero();  ///< of T_OC = object.T_FC, right perturbation

  /// Whether segmentation's frame A is not the last frame that was fused.
  bool bridged(const SegmentationResult& s) const {
    return started && (s.first || s.utime_a != last_utime);
  }
  /// From the last frame to `utime`, at most as long as constant velocity is believed.
  double secondsSince(std::int64_t utime) const;
  /// Least weighted inliers of a camera pose that is aligned to the static map.
  double minInliers() const;
  /// Least visible stable object pixels for tracking it, at the maps' resolution.
  double minObjectPixels() const;
};

/// The worse of two states; kInvalid counts as degraded.
Health worse(Health a, Health b);

/// What a step adds to a pose that is not aligned: the covariance that segmentation or prior gives,
/// inflated alike, without the floor that only keeps a start from being too tight.
Mat6 stepCovariance(const Mat6& covariance, const TrackingConfig& config);

/// `extra` of a start after a gap: ten times the usual standard deviations.
constexpr double kGapInflation = 100.0;

/// The segmentation's covariance as a start for tracking: inflated, never tighter than the floor
/// (times `extra`). A covariance that is not one, or beyond 1 m or 1 rad, is replaced by a wide
/// one.
Mat6 startCovariance(const Mat6& covariance, const TrackingConfig& config, double extra);

}  // namespace rf
