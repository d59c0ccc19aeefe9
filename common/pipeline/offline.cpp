// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/offline.hpp"

#include <utility>

namespace rf {

OfflinePipeline::OfflinePipeline(const PipelineConfig& config, const Camera& camera,
                                 PriorStage prior)
    : codec_(config.capture),
      prior_(std::move(prior)),
      segmentation_(config.segmentation, camera),
      fusion_(config.fusion, camera) {}

OfflinePipeline::Output OfflinePipeline::process(const RgbdFrame& frame, bool coded) {
  Output out;
  out.frame = coded ? frame : roundTrip(frame, codec_);
  out.prior = prior_.process(frame.utime, frame.seq);
  out.segmentation =
      segmentation_.process(out.frame, out.prior, has_state_ ? &last_state_ : nullptr);
  out.state = fusion_.process(out.frame, out.segmentation);
  last_state_ = out.state;
  has_state_ = true;
  return out;
}

}  // namespace rf
