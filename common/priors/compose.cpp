// SPDX-License-Identifier: BSD-3-Clause
#include "priors/compose.hpp"

#include <stdexcept>
#include <string>

namespace rf {
namespace {

PriorState both(PriorState a, PriorState b) {
  if (a == PriorState::kMissing || b == PriorState::kMissing) return PriorState::kMissing;
  const bool extrapolated = a == PriorState::kExtrapolated || b == PriorState::kExtrapolated;
  return extrapolated ? PriorState::kExtrapolated : PriorState::kValid;
}

/// T1 exp(e1) T2 exp(e2) = T1 T2 exp(Ad(T2^-1) e1 + e2 + O(e^2)).
Mat6 carried(const Mat6& cov_1, const SE3& T_2, const Mat6& cov_2) {
  const Mat6 ad = T_2.inverse().adjoint();
  return ad * cov_1 * ad.transpose() + cov_2;
}

/// The motion that object_cov belongs to.
SE3 objectIncrement(const MotionPrior& prior) {
  return prior.object_kind == ObjectPriorKind::kCameraFrame ? prior.T_XOa * prior.T_XOb.inverse()
                                                            : prior.T_XOa.inverse() * prior.T_XOb;
}

}  // namespace

MotionPrior composePriors(const MotionPrior& ab, const MotionPrior& bc) {
  if (ab.utime_b != bc.utime_a) {
    throw std::invalid_argument("composePriors: first pair ends at utime " +
                                std::to_string(ab.utime_b) + ", second begins at " +
                                std::to_string(bc.utime_a));
  }
  MotionPrior ac;
  ac.utime_a = ab.utime_a;
  ac.utime_b = bc.utime_b;
  ac.seq = bc.seq;
  ac.camera = both(ab.camera, bc.camera);
  if (ac.camera != PriorState::kMissing) {
    ac.T_CaCb = ab.T_CaCb * bc.T_CaCb;
    ac.camera_cov = carried(ab.camera_cov, bc.T_CaCb, bc.camera_cov);
    ac.T_WCb = bc.T_WCb;
  }
  if (ab.object_kind == bc.object_kind) {
    ac.object_kind = ab.object_kind;
    ac.object = both(ab.object, bc.object);
  }
  if (ac.object != PriorState::kMissing) {
    ac.T_XOa = ab.T_XOa;
    ac.T_XOb = bc.T_XOb;
    ac.object_cov = carried(ab.object_cov, objectIncrement(bc), bc.object_cov);
  }
  ac.self = bc.self;
  return ac;
}

}  // namespace rf
