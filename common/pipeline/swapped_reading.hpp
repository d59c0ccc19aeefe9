// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "geometry/se3.hpp"
#include "values/model_state.hpp"
#include "values/segmentation_result.hpp"
#include "values/swap_doubt.hpp"

namespace rf {

/// Where the poses would be if the world were the body and the body the world: there the object
/// has never moved, and the camera has what the object was given. Kept without a camera prior only.
class SwappedReading {
 public:
  /// `T_WO`: the object's pose after this frame, where it has a model; `born`: since this frame.
  void observe(const SegmentationResult& segmentation, bool born, const std::optional<SE3>& T_WO);

  /// The pose with the other reading's distance, d = log(T_W^-1 T_W'), in its covariance where that
  /// reading is possible: |d|^2 of translation and of rotation in all directions alike, since a
  /// matrix of d d^T and a pose's own millimetres is too near to singular. Its health follows.
  BodyPose widened(BodyPose pose) const;

 private:
  SwapDoubt doubt_;
  SE3 T_WW_;  ///< T_W' = T_WW_ T_W: poses of this reading -> poses of the other
  std::optional<SE3> last_T_WO_;
};

}  // namespace rf
