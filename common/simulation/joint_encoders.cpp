// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/joint_encoders.hpp"

#include <cmath>
#include <numbers>

#include "simulation/random.hpp"

namespace rf::sim {

JointPositions JointEncoders::read(const JointPositions& truth) const {
  JointPositions out = truth;
  std::uint64_t index = 0;
  for (auto& [name, value] : out) {
    Random random(seed_, 0xE2C0DE00ULL + index++);
    const bool head = name.starts_with("head");
    const bool finger = name.starts_with("finger");
    const double offset =
        finger ? 0.0 : random.normal() * (head ? model_.head_offset : model_.arm_offset);
    const double turn = 2 * std::numbers::pi;
    const double step =
        finger ? model_.finger_step : turn / std::exp2(head ? model_.head_bits : model_.arm_bits);
    value = std::floor((value + offset) / step) * step;
  }
  return out;
}

}  // namespace rf::sim
