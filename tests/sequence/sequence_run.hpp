// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/segmentation_score.hpp"
#include "evaluation/trajectory_error.hpp"
#include "pipeline/offline.hpp"
#include "values/surfel_point.hpp"

namespace rf {

/// What a sequence gave.
struct SequenceRun {
  Trajectory camera, object;
  std::vector<std::int64_t> frames;
  std::vector<Image<std::uint8_t>> masks;  ///< input size
  std::int64_t static_surfels = 0;
  std::vector<SurfelPoint> world;  ///< the static map at the end
};

/// Runs frames through the offline pipeline; `next` gives one frame a call and nothing at the end.
SequenceRun runSequence(const Camera& camera, const PipelineConfig& config, PriorStage prior,
                        const std::function<std::optional<RgbdFrame>()>& next);

}  // namespace rf
