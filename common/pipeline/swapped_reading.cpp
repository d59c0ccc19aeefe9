// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/swapped_reading.hpp"

#include "pipeline/pose_uncertainty.hpp"

namespace rf {

void SwappedReading::observe(const SegmentationResult& s, bool born,
                             const std::optional<SE3>& T_WO) {
  doubt_.observe(s);
  if (!s.has_prior_T_WC && !born && last_T_WO_ && T_WO) {
    T_WW_ = T_WW_ * *last_T_WO_ * T_WO->inverse();
  }
  last_T_WO_ = T_WO;
}

BodyPose SwappedReading::widened(BodyPose pose) const {
  if (!doubt_.possible()) return pose;
  const Vec6 d = (pose.T_W.inverse() * T_WW_ * pose.T_W).log();
  pose.covariance.diagonal().head<3>().array() += d.head<3>().squaredNorm();
  pose.covariance.diagonal().tail<3>().array() += d.tail<3>().squaredNorm();
  demoteUncertain(pose);
  return pose;
}

}  // namespace rf
