// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "values/health.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Body ids in ModelState::body and in exported models.
inline constexpr std::uint8_t kBodyNone = 0;
inline constexpr std::uint8_t kBodyStatic = 1;
inline constexpr std::uint8_t kBodyObject = 2;

/// A pose less certain than this is not called tracked, metres: half of the 10 cm by which a
/// tracked pose must never be off, so that these are two standard deviations.
inline constexpr double kTrustedSigma = 0.05;

/// One body's pose after frame-to-model refinement.
struct BodyPose {
  SE3 T_W;                             ///< T_WC for the camera, T_WO for the object
  Mat6 covariance = Mat6::Identity();  ///< right perturbation, translation first
  Health health = Health::kInvalid;
  double inliers = 0;       ///< frame-to-model inlier pixels
  double rms_residual = 0;  ///< metres, point to plane
};

/// What fusion knows after frame `seq` (paper section V). Bit-exact over the wire; also the
/// feedback to segmentation of the NEXT frame.
struct ModelState {
  std::int64_t utime = 0;
  std::int64_t seq = 0;
  BodyPose camera;
  bool object_exists = false;   ///< the object model has been born
  bool object_resting = false;  ///< frozen: it rests in the world
  BodyPose object;
  std::int64_t static_surfels = 0;
  std::int64_t object_surfels = 0;
  int reduction = 4;                        ///< input pixels per pixel of the planes below
  Image<std::uint16_t> predicted_depth_mm;  ///< front-most stable surface of both models, 0 = none
  Image<std::uint8_t> body;                 ///< kBodyNone / kBodyStatic / kBodyObject
  StageTimes stage_ms;
};

}  // namespace rf
