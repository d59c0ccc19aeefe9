// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/segmentation_stage.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>

#include "geometry/undistort.hpp"
#include "kinematics/self_filter.hpp"
#include "segmentation/paper_segmenter.hpp"
#include "segmentation/rigidfusion_segmenter.hpp"

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

/// Labels the working pixels that show the robot, if only in part.
void labelSelf(const Image<std::uint8_t>& self, const Undistorter& undistorter,
               SegmentationResult& result) {
  Image<std::uint16_t> wide(self.width(), self.height());
  std::copy(self.begin(), self.end(), wide.begin());
  const Image<std::uint16_t> ideal = undistorter.depth(wide);
  const int n = result.reduction;
  for (int v = 0; v < result.label.height(); ++v) {
    for (int u = 0; u < result.label.width(); ++u) {
      bool robot = false;
      for (int k = 0; k < n * n; ++k) robot |= ideal(u * n + k % n, v * n + k / n) != 0;
      if (!robot) continue;
      result.label(u, v) = kSelfLabel;
      result.score(u, v) = 255;
    }
  }
}

void noteSelf(const SelfMask& self, const RgbdFrame& frame, SegmentationResult& result) {
  const auto measured =
      std::count_if(frame.depth_mm.begin(), frame.depth_mm.end(), [](auto mm) { return mm != 0; });
  if (measured > 0) result.self_share = self.pixels / static_cast<double>(measured);
  const int there = self.pixels + self.behind;
  if (there > 0) result.self_behind = self.behind / static_cast<double>(there);
}

}  // namespace

struct SegmentationStage::Impl {
  Impl(const SegmentationConfig& config, const Camera& cam)
      : camera(cam), segmenter(makeSegmenter(config, cam)), self_config(config.self_filter) {}

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
  SelfFilterConfig self_config;
  std::optional<SelfFilter> self_filter;
  std::optional<Undistorter> undistorter;
};

SegmentationStage::SegmentationStage(const SegmentationConfig& config, const Camera& camera) {
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  impl_ = std::make_unique<Impl>(config, camera);
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
  const auto segment = [&](const RgbdFrame& seen) {
    return std::visit([&](auto& s) { return s.process(seen, prior, feedback); }, impl_->segmenter);
  };
  if (prior.self.empty() || !impl_->self_config.enabled) return segment(frame);
  const auto begin = std::chrono::steady_clock::now();
  const SelfMask self = impl_->selfOf(frame, prior);
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - begin;
  SegmentationResult result = segment(self.pixels > 0 ? without(frame, self.mask) : frame);
  if (self.pixels > 0) labelSelf(self.mask, *impl_->undistorter, result);
  noteSelf(self, frame, result);
  result.stage_ms.insert(result.stage_ms.begin(), {"self", spent.count()});
  return result;
}

void SegmentationStage::reset() {
  std::visit([](auto& s) { s.reset(); }, impl_->segmenter);
}

}  // namespace rf
