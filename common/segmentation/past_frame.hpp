// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "segmentation/image_terms.hpp"
#include "segmentation/prior_filter.hpp"

namespace rf {

/// A processed frame that may serve as reference A of later ones.
struct PastFrame {
  std::int64_t utime = 0;
  bool usable = false;            ///< had enough depth
  std::vector<TermLevel> levels;  ///< working resolution first; it stays empty (only masks need it)
  Image<float> mask_depth;        ///< at working resolution, only while the frame is the newest
  SE3 T_WC, T_CO;                 ///< own bookkeeping, refined by feedback
  bool camera_confirmed = false;  ///< tracked against the static map
  bool object_confirmed = false;  ///< tracked against its own model
  bool anchored = false;          ///< the models confirmed all that there is
  bool object_moves = false;
  bool body_seen = false;   ///< Decision::body_seen
  int moved_frames = 0;     ///< for so long two bodies were read the same way round
  int turned_frames = 0;    ///< Decision::turned_frames
  Increment camera_source;  ///< the prior as given; measured: false when it is missing
  Increment object_source;
  Increment camera;            ///< accepted prior increment from the frame before
  Increment object;            ///< the same: T_Oa^-1 T_Ob, or T(xi_d) from kinematics
  Image<std::uint8_t> memory;  ///< last known scores, kept while the object rests
};

}  // namespace rf
