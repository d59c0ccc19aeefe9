// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "values/health.hpp"

namespace rf {

/// Milliseconds spent in one named step; the order is the order of execution.
using StageTimes = std::vector<std::pair<std::string, double>>;

/// Relative motion of one rigid body between frames A and B, seen from the camera:
/// coordinates of a point of that body in C_B -> C_A (paper section III: T(xi_s), T(xi_d)).
struct BodyMotion {
  SE3 T_AB;
  Mat6 covariance = Mat6::Identity();  ///< right perturbation, frame C_B, translation first
  Health health = Health::kInvalid;
  double inliers = 0;  ///< weighted count of pixels that fit (solver resolution)
  double rms_residual =
      0;  ///< weighted rms of the whitened residuals, 1 = as the sensor model says
};

/// Label value of a working-resolution pixel without depth.
inline constexpr std::uint8_t kNoCluster = 255;
/// Label value of a working-resolution pixel that shows the robot itself, in whole or in part: it
/// took no part in the segmentation and is not to be tracked or fused.
inline constexpr std::uint8_t kSelfLabel = 254;
/// So clusters of a frame are labelled 0 .. kMaxClusters - 1.
inline constexpr std::size_t kMaxClusters = 254;

/// What segmentation says of one frame (paper section IV). Bit-exact over the wire.
struct SegmentationResult {
  std::int64_t utime = 0;      ///< frame B
  std::int64_t utime_a = 0;    ///< frame A that the motions refer to: the previous PROCESSED frame
  std::int64_t seq = 0;        ///< frame B
  int reduction = 2;           ///< input pixels per working pixel, both directions
  bool first = false;          ///< first frame of a stream: motions are identity and mean nothing
  bool object_moving = false;  ///< two bodies were needed; else gamma is 1 everywhere
  /// Mask and world were the wrong way round until frame A: what was the body is the world now, and
  /// the motions are those of this reading. Only without an object prior.
  bool turned = false;
  bool world_told = true;  ///< the priors tell which of two bodies is the world

  Image<std::uint8_t> label;  ///< cluster of each working pixel, kNoCluster, kSelfLabel
  Image<std::uint8_t> score;  ///< 255 * gamma of each working pixel; 255 where it has no cluster
  std::vector<float> gamma;   ///< per cluster, 1 static, 0 dynamic

  BodyMotion camera;         ///< of the static world: T(xi_s) = T_{CA CB}
  BodyMotion object;         ///< of the moving body:  T(xi_d); equals camera's while it rests
  double dynamic_share = 0;  ///< sum(1 - gamma) over pixels with depth / their number
  double self_share = 0;     ///< input pixels of the robot itself / those with depth
  /// Input pixels that show something behind the robot where it should be itself / those and its
  /// pixels, 0..1: near 0 where its shapes, joints and the camera's place are right.
  double self_behind = 0;
  std::string hypothesis;  ///< which reading of the frame won (short ASCII word)

  /// The camera prior's own absolute pose at B if it has one (world frame, start pose), see
  /// MotionPrior.
  bool has_prior_T_WC = false;
  SE3 prior_T_WC;
  /// The object's pose in camera B by segmentation's own bookkeeping, in the object frame of the
  /// object prior. Only with an object prior. Fusion uses it at the birth of the object model, to
  /// name the object frame as the prior does.
  bool has_T_CO = false;
  SE3 T_CO;

  StageTimes stage_ms;
};

}  // namespace rf
