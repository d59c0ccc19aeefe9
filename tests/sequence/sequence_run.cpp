// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_run.hpp"

#include <utility>

#include "datasets/mask_maker.hpp"

namespace rf {

SequenceRun runSequence(const Camera& camera, const PipelineConfig& config, PriorStage prior,
                        const std::function<std::optional<RgbdFrame>()>& next) {
  OfflinePipeline pipeline(config, camera, std::move(prior));
  MaskMaker masks(camera);
  SequenceRun run;
  while (const std::optional<RgbdFrame> frame = next()) {
    const OfflinePipeline::Output out = pipeline.process(*frame);
    run.frames.push_back(frame->utime);
    run.masks.push_back(masks.make(out.frame.depth_mm, out.segmentation.score,
                                   out.segmentation.label, out.segmentation.reduction));
    if (out.state.camera.health != Health::kLost)
      run.camera.push_back({frame->utime, out.state.camera.T_W});
    if (out.state.object_exists) run.object.push_back({frame->utime, out.state.object.T_W});
    run.static_surfels = out.state.static_surfels;
  }
  run.world = pipeline.fusion().surfels(kBodyStatic);
  return run;
}

}  // namespace rf
