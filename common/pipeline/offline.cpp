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

OfflinePipeline::Input OfflinePipeline::prepare(const RgbdFrame& frame, bool coded) {
  Input out;
  out.frame = coded ? frame : roundTrip(frame, codec_);
  out.prior = prior_.process(frame.utime, frame.seq);
  out.segmentation = segmentation_.prepare(out.frame, out.prior);
  return out;
}

OfflinePipeline::Output OfflinePipeline::process(Input input) {
  Output out;
  out.segmentation = segmentation_.process(std::move(input.segmentation), input.prior,
                                           has_state_ ? &last_state_ : nullptr);
  out.frame = std::move(input.frame);
  out.prior = std::move(input.prior);
  out.state = fusion_.process(out.frame, out.segmentation);
  last_state_ = out.state;
  has_state_ = true;
  return out;
}

OfflinePipeline::Output OfflinePipeline::process(const RgbdFrame& frame, bool coded) {
  return process(prepare(frame, coded));
}

}  // namespace rf
