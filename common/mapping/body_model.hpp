// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/se3.hpp"
#include "mapping/frame_maps.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/map_uncertainty.hpp"
#include "mapping/prediction.hpp"
#include "mapping/surfel_fusion.hpp"
#include "mapping/surfel_map.hpp"
#include "values/surfel_point.hpp"

namespace rf {

/// One rigid body: its surfels in its own frame F, the camera in that frame, and what the camera
/// should see. The static world and the moving object are both one of these.
struct BodyModel {
  SurfelMap map;
  SurfelCleaner cleaner;
  Predictor predictor;
  Prediction prediction;  ///< at T_FC
  SE3 T_FC;               ///< camera in the body's frame
  MapUncertainty uncertainty;

  BodyModel(const FusionConfig& config, const Camera& camera);
};

/// Pixels (1) where the measured depth lies on the predicted stable surface of a body.
Image<std::uint8_t> explainedBy(const Prediction& prediction, const FrameMaps& frame,
                                const FusionConfig& config);

/// How well the predicted stable surface of a body agrees with a frame, in pixels.
struct Agreement {
  double on_surface = 0;  ///< measured where predicted
  double through = 0;     ///< measured behind it
  double hidden = 0;      ///< measured before it, or not at all
};
Agreement agreement(const Prediction& prediction, const FrameMaps& frame,
                    const FusionConfig& config);

/// Predicted pixels of stable surfels.
std::int64_t stablePixels(const Prediction& prediction, float stable_logit);

/// Front-most stable surface of two bodies, `reduction` input pixels per pixel of the planes, from
/// predictions of `model_reduction` input pixels per pixel. Where both are within 2 cm it is the
/// object.
struct FeedbackPlanes {
  Image<std::uint16_t> depth_mm;
  Image<std::uint8_t> body;
};
FeedbackPlanes feedbackPlanes(const Prediction& world, const Prediction* object,
                              const Camera& input, int model_reduction, int reduction,
                              float stable_logit);

/// Surfels of at least export_confidence, mapped by T (body frame to the frame of the export), in
/// the map's own order. Remnants of what has vanished are left out unless export_remnants is set.
std::vector<SurfelPoint> exportSurfels(const BodyModel& body, const SE3& T,
                                       const SurfelConfig& config);

}  // namespace rf
