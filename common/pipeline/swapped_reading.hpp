// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "geometry/se3.hpp"
#include "values/model_state.hpp"
#include "values/segmentation_result.hpp"
#include "values/swap_doubt.hpp"

namespace rf {

/// What fusion made of a frame, as far as it tells which of two bodies is the world.
struct ReadFrame {
  SE3 T_WC;
  std::optional<SE3> T_WO;  ///< where the object has a model
  bool born = false;        ///< that model, in this frame
};

/// Where the poses would be if the world were the body and the body the world: there the object
/// has never moved, and the camera has what the object was given. The readings may also have
/// changed on the way, so the largest distance so far counts, although the object may be back.
///
/// The camera prior is the witness between the two. A second of it speaks for our reading where it
/// fits that clearly better than the other one; motion that lies in such a second is not in doubt.
/// Without a camera prior all motion is.
class SwappedReading {
 public:
  void observe(const SegmentationResult& segmentation, const ReadFrame& frame);

  /// Our reading and the other one change places: the camera's poses become T_WW times what they
  /// were, with the value that it had in each frame, given at the last one. `T_WO`: the object's
  /// pose then.
  void turn(const SE3& T_WW, const SE3& T_WO);

  /// The pose with the other reading's distance, d = log(T_W^-1 T_W'), in its covariance where that
  /// reading is possible: the largest |d|^2 of translation and of rotation in all directions alike,
  /// since a matrix of d d^T and a pose's own millimetres is too near to singular. Its health
  /// follows.
  BodyPose widened(BodyPose pose) const;

 private:
  struct Step {
    std::int64_t utime = 0;
    SE3 T_WC;
    std::optional<SE3> prior_T_WC;
    SE3 body;  ///< since the frame before: poses of this reading -> poses of the other
    bool in_doubt = true;
  };

  bool priorConfirms() const;
  SE3 distance() const;

  SwapDoubt doubt_;
  std::deque<Step> window_;  ///< oldest first: the last frame that is a second old, and all since
  SE3 left_window_;          ///< motion in doubt before it
  Eigen::Vector2d reach_ = Eigen::Vector2d::Zero();  ///< largest |d|^2 of that, m^2 and rad^2
  std::optional<SE3> last_T_WO_;
};

}  // namespace rf
