// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/sensor_model.hpp"
#include "mapping/surfel_map.hpp"

namespace rf {

/// What a camera would see of one body's surfels. All planes have the camera's size; where nothing
/// is seen depth is 0 and id kNoSurfel. Points and normals are in the camera frame.
struct Prediction {
  Camera camera;
  Image<std::uint32_t> id;
  Image<float> depth;       ///< metres along z, of the disc's plane at the pixel
  Image<float> nx, ny, nz;  ///< unit normal, facing the camera
  Image<float> intensity;   ///< 0..1
  Image<float> logit;       ///< log-odds of confidence
  std::vector<int> blocks;  ///< blocks of the map whose box meets the view, ascending

  /// Empty planes of the camera's size.
  static Prediction nothing(const Camera& camera);
};

/// Limits of the drawing; see SurfelConfig and SensorConfig.
struct PredictOptions {
  float near_m = 0.1F;
  float far_m = 6.0F;
  float radius_min_px = 0.7F;
  float stable_logit = -1.1F;
  float unstable_bias =
      0.012F;              ///< unstable surfels are compared as if this much farther (relative)
  float rim_sigma = 8.5F;  ///< a disc's rim is compared as if so many depth sigmas farther
  SensorModel sensor{SensorConfig{}};
  float facing_cos = 0.05F;  ///< discs seen flatter than this, or from behind, are not drawn

  static PredictOptions from(const FusionConfig& config);
};

/// Log-odds of a probability.
float logit(double probability);

/// Draws the map from a camera at T_FC: nearest disc at each pixel (ray and tangent plane, inside
/// the radius), ties to the lowest id. On a disc's plane 1/z is linear in the pixel, so the inner
/// loop has no division; keys bits(1/z) << 32 | ~id make the result independent of drawing order
/// and threads. Reuses the planes of `out`.
class Predictor {
 public:
  void predict(const SurfelMap& map, const SE3& T_FC, const Camera& camera,
               const PredictOptions& options, Prediction& out);

 private:
  std::vector<std::vector<std::int64_t>> keys_;  // one z-buffer a thread
};

/// Blocks whose box (grown by the largest radius) may be seen from T_FC.
std::vector<int> visibleBlocks(const SurfelMap& map, const SE3& T_FC, const Camera& camera,
                               float near_m, float far_m);

}  // namespace rf
