// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/se3.hpp"

namespace rf {

/// Information-weighted motion prior on the pair (T_s, T_d) of one frame pair A, B
/// (docs/ALGORITHM.md "Priors"): rho(e_s) + rho(e_d), rho = Huber on the Mahalanobis norm.
///   e_s = log(T~_s^-1 T_s)
///   relative object prior (pose source in the world): e_d = log((G T_s)^-1 T_d), so that the
///   camera's own drift cancels; absolute (arm kinematics): e_d = log(T~_d^-1 T_d).
struct JointPrior {
  enum class Object { kNone, kRelative, kAbsolute };

  SE3 T_s;                            ///< prior camera motion
  Mat6 information_s = Mat6::Zero();  ///< right perturbation, frame C_B; zero = no prior
  Object object = Object::kNone;
  SE3 object_motion;                  ///< G (relative) or T~_d (absolute)
  Mat6 information_d = Mat6::Zero();  ///< right perturbation, frame C_B
  /// Without an object prior a cluster may leave the static world although no body explains it
  /// (people, cloth): the object's energy is then capped by an outlier energy.
  bool outlier_class = false;

  Vec6 staticError(const SE3& T_s_estimate) const;
  Vec6 objectError(const SE3& T_s_estimate, const SE3& T_d_estimate) const;
  /// The object motion that this prior expects beside a given camera motion (identity G: the same).
  SE3 expectedObject(const SE3& T_s_estimate) const;
  /// The camera motion that this prior expects beside a given object motion (relative kind only).
  SE3 expectedCamera(const SE3& T_d_estimate) const;
  /// rho_s + rho_d, negative log likelihood up to a constant.
  double cost(const SE3& T_s_estimate, const SE3& T_d_estimate) const;
};

/// Huber negative log likelihood of a Mahalanobis distance: chi^2/2, linear beyond kPriorHuber.
double huberCost(double chi);
/// Its IRLS weight.
double huberWeight(double chi);

/// Where the prior's quadratic turns linear, in sigma: a lie then costs a bounded slope, but a
/// redescending cost would make a label swap cheap (measured worse).
inline constexpr double kPriorHuber = 3.5;

}  // namespace rf
