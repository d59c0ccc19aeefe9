// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "priors/drift.hpp"
#include "values/stamped_pose.hpp"

namespace rf {

/// addDrift for trajectories; the first pose is kept.
Trajectory withDrift(const Trajectory& trajectory, const DriftSpec& spec);

}  // namespace rf
