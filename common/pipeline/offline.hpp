// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "geometry/camera.hpp"
#include "pipeline/fusion_stage.hpp"
#include "pipeline/pipeline_config.hpp"
#include "pipeline/prior_stage.hpp"
#include "pipeline/segmentation_stage.hpp"
#include "values/frame_source.hpp"

namespace rf {

/// The four stages in a row, as lockstep runs them: codec, prior, segmentation (with the model
/// state of the frame before as feedback), fusion. What the five processes do with messages
/// between.
class OfflinePipeline {
 public:
  struct Output {
    RgbdFrame frame;    ///< after the codec
    MotionPrior prior;  ///< as segmentation got it
    SegmentationResult segmentation;
    ModelState state;
  };

  /// A frame on its way: all that depends on it alone.
  struct Input {
    RgbdFrame frame;  ///< after the codec
    MotionPrior prior;
    SegmentationInput segmentation;
  };

  OfflinePipeline(const PipelineConfig& config, const Camera& camera, PriorStage prior);

  /// First half of process(); frames in their order, one of them beside process() of the frame
  /// before. Throws std::invalid_argument when the frame's size is not the camera's. `coded`: the
  /// frame's colour went through the codec before, as in logs.
  Input prepare(const RgbdFrame& frame, bool coded = false);
  Output process(Input input);
  /// Both halves.
  Output process(const RgbdFrame& frame, bool coded = false);
  const FusionStage& fusion() const { return fusion_; }

 private:
  CodecOptions codec_;
  PriorStage prior_;
  SegmentationStage segmentation_;
  FusionStage fusion_;
  ModelState last_state_;
  bool has_state_ = false;
};

}  // namespace rf
