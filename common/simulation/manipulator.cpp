// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/manipulator.hpp"

#include <algorithm>

#include "simulation/robot_description.hpp"

namespace rf::sim {

SE3 Manipulator::cameraAt(double t) const {
  return base_at(t) * model.T_AB(kBaseLink, kCameraLink, joints_at(t));
}

SE3 Manipulator::objectAt(double t) const {
  const double at = std::max(t, grasp_time);
  return base_at(at) * model.T_AB(kBaseLink, kGripperLink, joints_at(at)) * T_GO;
}

}  // namespace rf::sim
