// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/joint_prior.hpp"

#include <cmath>

namespace rf {

double huberCost(double chi) {
  return chi <= kPriorHuber ? 0.5 * chi * chi : kPriorHuber * (chi - 0.5 * kPriorHuber);
}

double huberWeight(double chi) { return chi <= kPriorHuber ? 1.0 : kPriorHuber / chi; }

Vec6 JointPrior::staticError(const SE3& T_s_estimate) const {
  return (T_s.inverse() * T_s_estimate).log();
}

SE3 JointPrior::expectedObject(const SE3& T_s_estimate) const {
  switch (object) {
    case Object::kRelative:
      return object_motion * T_s_estimate;
    case Object::kAbsolute:
      return object_motion;
    case Object::kNone:
      break;
  }
  return T_s_estimate;
}

SE3 JointPrior::expectedCamera(const SE3& T_d_estimate) const {
  return object == Object::kRelative ? object_motion.inverse() * T_d_estimate : T_s;
}

Vec6 JointPrior::objectError(const SE3& T_s_estimate, const SE3& T_d_estimate) const {
  return (expectedObject(T_s_estimate).inverse() * T_d_estimate).log();
}

double JointPrior::cost(const SE3& T_s_estimate, const SE3& T_d_estimate) const {
  const Vec6 e_s = staticError(T_s_estimate);
  double total = huberCost(std::sqrt(std::max(0.0, e_s.dot(information_s * e_s))));
  if (object != Object::kNone) {
    const Vec6 e_d = objectError(T_s_estimate, T_d_estimate);
    total += huberCost(std::sqrt(std::max(0.0, e_d.dot(information_d * e_d))));
  }
  return total;
}

}  // namespace rf
