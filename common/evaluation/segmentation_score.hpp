// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/image.hpp"

namespace rf {

/// Pixels of one frame by truth and by what was found: 1 static, 2 dynamic, 3 the robot itself.
/// Truth 0 (unknown) and pixels without input depth (found 0) are not counted. The robot's true
/// pixels are neither static nor dynamic; an object's pixel taken for the robot is dynamic_wrong, a
/// static one is not counted among the static.
struct PixelCounts {
  std::int64_t static_right = 0;
  std::int64_t static_wrong = 0;  ///< truly static, found dynamic
  std::int64_t dynamic_right = 0;
  std::int64_t dynamic_wrong = 0;  ///< truly dynamic, found static or taken for the robot
  std::int64_t self_right = 0;
  std::int64_t self_missed = 0;  ///< truly the robot, found static or dynamic
  std::int64_t self_wrong = 0;   ///< truly static or dynamic, taken for the robot

  PixelCounts& operator+=(const PixelCounts& other);
  bool hasDynamic() const { return dynamic_right + dynamic_wrong + static_wrong > 0; }
  /// Intersection over union of the dynamic class; 1 when nothing is and was found dynamic.
  double iou() const;
  double staticAccuracy() const;   ///< share of truly static pixels found so; 1 when there is none
  double dynamicAccuracy() const;  ///< the same of truly dynamic pixels
  double selfRecall() const;       ///< share of the robot's pixels found so; 1 when there is none
  double selfPrecision() const;    ///< share of pixels found to be the robot's that truly are
};

/// Throws std::invalid_argument when the sizes differ.
PixelCounts countPixels(const Image<std::uint8_t>& truth, const Image<std::uint8_t>& found);

/// A frame whose result is missing: all truly dynamic pixels count as not found.
PixelCounts countMissing(const Image<std::uint8_t>& truth);

/// Numbers over a set of frames.
struct SegmentationScore {
  std::size_t frames = 0;
  std::size_t missing = 0;  ///< of those, frames without a result
  double iou = 0;           ///< over the pixels of all frames together
  double iou_mean = 0;      ///< over frames in which anything is or was found dynamic
  double iou_median = 0;
  double iou_min = 0;
  double static_accuracy = 0;  ///< pixels of all frames together
  double dynamic_accuracy = 0;
};
SegmentationScore scoreSegmentation(const std::vector<PixelCounts>& frames, std::size_t missing);

}  // namespace rf
