// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "geometry/se3.hpp"
#include "mapping/frame_maps.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/prediction.hpp"
#include "mapping/surfel_map.hpp"
#include "mapping/vanished_surface.hpp"

namespace rf {

/// What association decided for a pixel, beside the ids of matched surfels.
inline constexpr std::uint32_t kMatchNone = kNoSurfel;         ///< nothing to do
inline constexpr std::uint32_t kMatchAppend = kNoSurfel - 1U;  ///< a new surfel

/// Input of one body's fusion of one frame.
struct FuseInput {
  const FrameMaps& frame;
  const BodyWeights& weights;        ///< of this body
  const Image<std::uint8_t>& other;  ///< interior of the other body
  /// Pixels that the body must not take (1), for example those that the other body explains. May be
  /// empty: none.
  const Image<std::uint8_t>& forbidden;
  SE3 T_FC;               ///< camera in the body's frame, the pose of `prediction`
  std::int32_t time = 0;  ///< frame counter, grows by 1
  bool first = false;     ///< the model's first frame: surfels start with birth_confidence
  double miss = 1.0;      ///< factor on miss_log_odds
};

struct FuseStats {
  std::int64_t matched = 0;   ///< pixels
  std::int64_t appended = 0;  ///< surfels
  std::vector<int> grown;     ///< blocks that got new surfels, ascending
};

/// Association through the prediction's id map (performance.md section 3): a pixel belongs to the
/// disc seen there when it lies within the sensor's noise of the disc's plane; pixels before the
/// predicted surface, or where there is none, become new surfels; pixels behind it do nothing
/// (looking through is the business of cleaning). Returns a surfel id, kMatchNone or kMatchAppend
/// for each pixel.
Image<std::uint32_t> associate(const FuseInput& in, const Prediction& prediction,
                               const FusionConfig& config);

/// Weighted fusion of a frame into the map (paper section V; confidence in log-odds after
/// StaticFusion) and of the new surfels into the prediction, which then serves the next frame's
/// tracking. All pixels that hit a surfel are averaged along its normal, weighted by their share
/// and precision.
FuseStats fuseFrame(const FuseInput& in, const FusionConfig& config, SurfelMap& map,
                    Prediction& prediction);

/// Removes surfels whose place the sensor looks through, and surfels that have not become stable
/// within unstable_age frames. Looks only at the visible blocks and at those that grew then.
class SurfelCleaner {
 public:
  /// Notes that a block got new surfels at `time`.
  void noteGrowth(const std::vector<int>& blocks, std::int32_t time);
  /// `visible`: blocks in view. Returns the number of removed surfels. Ids change: the id map of an
  /// earlier prediction must not be used afterwards.
  std::int64_t clean(const FrameMaps& frame, const SE3& T_FC, std::int32_t time,
                     const FusionConfig& config, const std::vector<int>& visible, SurfelMap& map);
  /// Of the surfels removed because the sensor looked through or the other body was there, those
  /// that more than one frame had measured.
  const VanishedSurface& vanished() const { return vanished_; }

 private:
  struct Growth {
    std::int32_t time;
    std::vector<int> blocks;
  };
  void noteVanished(const SurfelBlock& block, std::int32_t time);

  std::deque<Growth> growth_;
  VanishedSurface vanished_;
};

}  // namespace rf
