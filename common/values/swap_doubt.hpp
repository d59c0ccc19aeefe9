// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "values/segmentation_result.hpp"

namespace rf {

/// Whether the world may have been taken for the body. Without a prior for the camera or without
/// one for the object the larger of two motions is read as the world's (docs/HEALTH.md), and only
/// habit keeps that right once the body fills more than half of the view: from then on pictures
/// cannot tell which of both moves, and nothing that follows can either. Where no prior tells at
/// all, not even at its birth, a third of the view is enough (overtake without an object prior was
/// read wrong at 34 %). Fusion and segmentation each keep one, fed alike.
class SwapDoubt {
 public:
  void observe(const SegmentationResult& s) {
    const bool told = s.has_prior_T_WC && s.has_T_CO;
    const double most = s.world_told ? kMajority : kThird;
    if (!told && s.object_moving && s.dynamic_share > most) possible_ = true;
  }
  bool possible() const { return possible_; }

 private:
  static constexpr double kMajority = 0.5;
  static constexpr double kThird = 1.0 / 3.0;  ///< the world no more than twice as large
  bool possible_ = false;
};

}  // namespace rf
