// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/pyramid.hpp"
#include "geometry/undistort.hpp"
#include "segmentation/clusters.hpp"
#include "segmentation/image_terms.hpp"
#include "segmentation/segmentation_config.hpp"
#include "values/frame.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// A frame as a segmenter reads it: all that depends on no other frame.
struct PreparedFrame {
  std::int64_t utime = 0;
  std::int64_t seq = 0;
  bool usable = false;             ///< has enough depth
  std::vector<RgbdLevel> pyramid;  ///< working resolution first, without distortion
  std::vector<TermLevel> terms;  ///< of the same levels where asked for; the first one stays empty
  Clusters clusters;
  StageTimes stage_ms;  ///< "prepare" and "cluster"
};

/// What a segmenter wants of its frames.
struct PreparationNeeds {
  int levels = 1;      ///< of the pyramid
  int clusters = 1;    ///< K
  bool terms = false;  ///< image terms of the levels below the first
};

/// Makes prepared frames. Its one member is const: frames may be prepared while an earlier one is
/// segmented. Deterministic for every thread count.
class FramePreparer {
 public:
  /// Throws std::invalid_argument when the calibration is unusable.
  FramePreparer(const SegmentationConfig& config, const Camera& camera,
                const PreparationNeeds& needs);

  /// Throws std::invalid_argument when the frame's size is not the camera's.
  PreparedFrame prepare(const RgbdFrame& frame) const;

 private:
  SegmentationConfig config_;
  PreparationNeeds needs_;
  Camera camera_;
  Undistorter undistorter_;
};

}  // namespace rf
