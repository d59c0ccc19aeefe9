// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/fusion_config.hpp"

namespace rf {

/// Where the object model is in its life.
enum class ObjectPhase {
  kNone,     ///< no model
  kMoving,   ///< tracked and growing
  kResting,  ///< frozen: its pose in the world is constant
};

/// What has to be done with the object model in a frame.
enum class ObjectAction {
  kNothing,  ///< there is no model and no reason for one
  kBirth,    ///< make it from this frame's dynamic pixels
  kMove,     ///< T_OC <- T_OC T(xi_d), refine, fuse
  kRest,     ///< T_OC = T_WO^-1 T_WC, nothing is fused
  kForget,   ///< it was a false alarm: drop it
};

struct ObjectLife {
  ObjectPhase phase = ObjectPhase::kNone;
  int moving_frames = 0;  ///< since birth, in total
};

/// Advances the life cycle by one frame. `moving` and `share` are the segmentation's object_moving
/// and dynamic_share; `travelled_m` is how far the object is from where it was born.
ObjectAction advance(ObjectLife& life, bool moving, double share, double travelled_m,
                     const ObjectModelConfig& config);

}  // namespace rf
