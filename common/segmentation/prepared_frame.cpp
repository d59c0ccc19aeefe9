// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/prepared_frame.hpp"

#include <algorithm>
#include <utility>

#include "values/stage_clock.hpp"

namespace rf {

FramePreparer::FramePreparer(const SegmentationConfig& config, const Camera& camera,
                             const PreparationNeeds& needs)
    : config_(config), needs_(needs), camera_(camera), undistorter_(camera) {
  config_.clusters.count = needs.clusters;
}

PreparedFrame FramePreparer::prepare(const RgbdFrame& frame) const {
  StageClock clock;
  PreparedFrame out;
  out.utime = frame.utime;
  out.seq = frame.seq;
  RgbdLevel finest = reduceFrame(undistorter_.colour(frame.colour),
                                 undistorter_.depth(frame.depth_mm), camera_.undistorted(),
                                 config_.reduction, config_.min_depth_m, config_.max_depth_m);
  const auto measured =
      std::count_if(finest.depth.begin(), finest.depth.end(), [](float z) { return z > 0; });
  out.usable = static_cast<double>(measured) >=
               config_.min_depth_share * static_cast<double>(finest.depth.size());
  out.pyramid = buildPyramid(std::move(finest), needs_.levels);
  if (needs_.terms) {
    out.terms.resize(out.pyramid.size());
    for (std::size_t level = 1; level < out.pyramid.size(); ++level) {
      out.terms[level] = makeTermLevel(out.pyramid[level]);
    }
  }
  clock.lap("prepare", out.stage_ms);
  out.clusters = clusterFrame(out.pyramid, config_.clusters);
  clock.lap("cluster", out.stage_ms);
  return out;
}

}  // namespace rf
