// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/segmentation_stage.hpp"

#include <stdexcept>
#include <string>
#include <variant>

#include "segmentation/paper_segmenter.hpp"
#include "segmentation/rigidfusion_segmenter.hpp"

namespace rf {
namespace {

using Segmenter = std::variant<RigidFusionSegmenter, PaperSegmenter>;

Segmenter makeSegmenter(const SegmentationConfig& config, const Camera& camera) {
  if (config.mode == "rigidfusion") return RigidFusionSegmenter(config, camera);
  return PaperSegmenter(config, camera);  // knows the other modes and refuses unknown ones
}

}  // namespace

struct SegmentationStage::Impl {
  Camera camera;
  Segmenter segmenter;
};

SegmentationStage::SegmentationStage(const SegmentationConfig& config, const Camera& camera) {
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  impl_ = std::make_unique<Impl>(Impl{camera, makeSegmenter(config, camera)});
}

SegmentationStage::~SegmentationStage() = default;

SegmentationResult SegmentationStage::process(const RgbdFrame& frame, const MotionPrior& prior,
                                              const ModelState* feedback) {
  const Camera& camera = impl_->camera;
  if (frame.depth_mm.width() != camera.width || frame.depth_mm.height() != camera.height ||
      frame.colour.width() != camera.width || frame.colour.height() != camera.height) {
    throw std::invalid_argument("frame " + std::to_string(frame.seq) + ": size " +
                                std::to_string(frame.depth_mm.width()) + "x" +
                                std::to_string(frame.depth_mm.height()) + " is not the camera's " +
                                std::to_string(camera.width) + "x" + std::to_string(camera.height));
  }
  return std::visit([&](auto& s) { return s.process(frame, prior, feedback); }, impl_->segmenter);
}

void SegmentationStage::reset() {
  std::visit([](auto& s) { s.reset(); }, impl_->segmenter);
}

}  // namespace rf
