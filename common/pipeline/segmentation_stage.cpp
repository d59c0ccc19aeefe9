// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/segmentation_stage.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "geometry/undistort.hpp"
#include "kinematics/self_filter.hpp"
#include "segmentation/paper_segmenter.hpp"
#include "segmentation/rigidfusion_segmenter.hpp"
#include "values/stage_clock.hpp"

namespace rf {
namespace {

using Segmenter = std::variant<RigidFusionSegmenter, PaperSegmenter>;

Segmenter makeSegmenter(const SegmentationConfig& config, const Camera& camera) {
  if (config.mode == "rigidfusion") return RigidFusionSegmenter(config, camera);
  return PaperSegmenter(config, camera);  // knows the other modes and refuses unknown ones
}

/// The frame as the segmenter is to see it: no depth where the robot is.
RgbdFrame without(const RgbdFrame& frame, const Image<std::uint8_t>& self) {
  RgbdFrame out = frame;
  for (std::size_t i = 0; i < self.size(); ++i) {
    if (self[i] != 0) out.depth_mm[i] = 0;
  }
  return out;
}

/// The working pixels that show the robot, if only in part.
Image<std::uint8_t> reduced(const Image<std::uint8_t>& self, const Undistorter& undistorter,
                            int reduction) {
  Image<std::uint16_t> wide(self.width(), self.height());
  std::copy(self.begin(), self.end(), wide.begin());
  const Image<std::uint16_t> ideal = undistorter.depth(wide);
  const int n = reduction;
  Image<std::uint8_t> out(self.width() / n, self.height() / n, 0);
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) {
      for (int k = 0; k < n * n; ++k) out(u, v) |= ideal(u * n + k % n, v * n + k / n) != 0;
    }
  }
  return out;
}

void noteSelf(const SelfMask& self, const RgbdFrame& frame, SegmentationInput& input) {
  const auto measured =
      std::count_if(frame.depth_mm.begin(), frame.depth_mm.end(), [](auto mm) { return mm != 0; });
  if (measured > 0) input.self_share = self.pixels / static_cast<double>(measured);
  const int there = self.pixels + self.behind;
  if (there > 0) input.self_behind = self.behind / static_cast<double>(there);
}

/// Labels the robot in the result.
void labelSelf(const SegmentationInput& input, SegmentationResult& result) {
  for (std::size_t i = 0; i < input.self.size(); ++i) {
    if (input.self[i] == 0) continue;
    result.label[i] = kSelfLabel;
    result.score[i] = 255;
  }
  result.self_share = input.self_share;
  result.self_behind = input.self_behind;
}

}  // namespace

struct SegmentationStage::Impl {
  Impl(const SegmentationConfig& config, const Camera& cam)
      : camera(cam),
        segmenter(makeSegmenter(config, cam)),
        reduction(config.reduction),
        self_config(config.self_filter) {}

  /// The robot's own pixels; made at the first prior that knows its shapes.
  SelfMask selfOf(const RgbdFrame& frame, const MotionPrior& prior) {
    if (!self_filter) {
      self_filter.emplace(self_config, camera);
      undistorter.emplace(camera);
    }
    return self_filter->find(prior.self, frame.depth_mm);
  }

  Camera camera;
  Segmenter segmenter;
  int reduction;
  SelfFilterConfig self_config;
  std::optional<SelfFilter> self_filter;   // read and made by prepare() alone
  std::optional<Undistorter> undistorter;  // the same
};

SegmentationStage::SegmentationStage(const SegmentationConfig& config, const Camera& camera) {
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  impl_ = std::make_unique<Impl>(config, camera);
}

SegmentationStage::~SegmentationStage() = default;

SegmentationInput SegmentationStage::prepare(const RgbdFrame& frame, const MotionPrior& prior) {
  const Camera& camera = impl_->camera;
  if (frame.depth_mm.width() != camera.width || frame.depth_mm.height() != camera.height ||
      frame.colour.width() != camera.width || frame.colour.height() != camera.height) {
    throw std::invalid_argument("frame " + std::to_string(frame.seq) + ": size " +
                                std::to_string(frame.depth_mm.width()) + "x" +
                                std::to_string(frame.depth_mm.height()) + " is not the camera's " +
                                std::to_string(camera.width) + "x" + std::to_string(camera.height));
  }
  SegmentationInput out;
  const auto prepared = [&](const RgbdFrame& seen) {
    return std::visit([&](const auto& s) { return s.prepare(seen); }, impl_->segmenter);
  };
  if (prior.self.empty() || !impl_->self_config.enabled) {
    out.frame = prepared(frame);
    return out;
  }
  StageClock clock;
  const SelfMask self = impl_->selfOf(frame, prior);
  noteSelf(self, frame, out);
  if (self.pixels > 0) out.self = reduced(self.mask, *impl_->undistorter, impl_->reduction);
  clock.lap("self", out.self_ms);
  out.frame = prepared(self.pixels > 0 ? without(frame, self.mask) : frame);
  return out;
}

SegmentationResult SegmentationStage::process(SegmentationInput input, const MotionPrior& prior,
                                              const ModelState* feedback) {
  SegmentationResult result =
      std::visit([&](auto& s) { return s.process(std::move(input.frame), prior, feedback); },
                 impl_->segmenter);
  labelSelf(input, result);
  result.stage_ms.insert(result.stage_ms.begin(), input.self_ms.begin(), input.self_ms.end());
  return result;
}

SegmentationResult SegmentationStage::process(const RgbdFrame& frame, const MotionPrior& prior,
                                              const ModelState* feedback) {
  return process(prepare(frame, prior), prior, feedback);
}

void SegmentationStage::reset() {
  std::visit([](auto& s) { s.reset(); }, impl_->segmenter);
}

}  // namespace rf
