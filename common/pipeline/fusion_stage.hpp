// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/camera.hpp"
#include "mapping/fusion_config.hpp"
#include "values/frame.hpp"
#include "values/model_state.hpp"
#include "values/segmentation_result.hpp"
#include "values/surfel_point.hpp"

namespace rf {

/// Surfel fusion of both bodies and frame-to-model refinement as a plain object: values in, values
/// out. Deterministic for every thread count. Not thread-safe.
class FusionStage {
 public:
  /// Throws std::invalid_argument when the configuration or the calibration is unusable.
  FusionStage(const FusionConfig& config, const Camera& camera);
  ~FusionStage();

  /// Refines both poses against the models, fuses the frame, predicts. `frame.utime` and
  /// `segmentation.utime` must be equal (else std::invalid_argument, state unchanged).
  ModelState process(const RgbdFrame& frame, const SegmentationResult& segmentation);

  /// The stable surfels of kBodyStatic or kBodyObject, in a deterministic order; may be empty.
  std::vector<SurfelPoint> surfels(std::uint8_t body) const;

  /// Forgets everything, as if new.
  void reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rf
