// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/fusion_config.hpp"

namespace rf {

/// Where the object model is in its life.
enum class ObjectPhase {
  kNone,      ///< no model
  kMoving,    ///< tracked and growing
  kResting,   ///< frozen: its pose in the world is constant
  kCoasting,  ///< segmentation does not see it: it goes where its prior says
};

/// What has to be done with the object model in a frame.
enum class ObjectAction {
  kNothing,  ///< there is no model and no reason for one
  kBirth,    ///< make it from this frame's dynamic pixels
  kMove,     ///< T_OC <- T_OC T(xi_d), refine, fuse
  kRest,     ///< T_OC = T_WO^-1 T_WC, nothing is fused
  kCoast,    ///< T_OC <- T_OC T(xi_d), look for the model there, nothing is fused
  kJoin,     ///< it has rested for so long that it becomes part of the static map
  kForget,   ///< it was a false alarm: drop it
};

struct ObjectLife {
  ObjectPhase phase = ObjectPhase::kNone;
  int moving_frames = 0;  ///< since birth, in total
};

/// What a frame says of the object.
struct ObjectSigns {
  bool moving = false;  ///< segmentation's object_moving
  bool unseen = false;  ///< segmentation has no pixels of it: its motion is the prior's or a guess
  double share = 0;     ///< segmentation's dynamic_share
  double travelled_m = 0;  ///< how far it is from where it was born
  double rested_s = 0;     ///< how long it has been resting
};

/// Advances the life cycle by one frame.
ObjectAction advance(ObjectLife& life, const ObjectSigns& signs, const ObjectModelConfig& config);

}  // namespace rf
