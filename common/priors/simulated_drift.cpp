// SPDX-License-Identifier: BSD-3-Clause
#include "priors/simulated_drift.hpp"

namespace rf {

Trajectory withDrift(const Trajectory& trajectory, const DriftSpec& spec) {
  std::vector<DriftPose> poses;
  poses.reserve(trajectory.size());
  for (const StampedPose& p : trajectory) poses.emplace_back(p.utime, p.pose);
  Trajectory drifted;
  drifted.reserve(poses.size());
  for (const auto& [utime, pose] : addDrift(poses, spec)) drifted.push_back({utime, pose});
  return drifted;
}

}  // namespace rf
