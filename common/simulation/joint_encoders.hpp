// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "kinematics/robot_model.hpp"

namespace rf::sim {

/// How well a robot knows its joints: every encoder has a zero that is off by a constant and steps.
struct EncoderModel {
  double head_offset = 0.002;  ///< standard deviation of the zero, radians
  double arm_offset = 0.0007;
  int head_bits = 12;  ///< steps a turn: 2^bits
  int arm_bits = 14;
  double finger_step = 0.0001;  ///< metres
};

/// Joint positions as the encoders of one robot give them. The seed decides the offsets.
class JointEncoders {
 public:
  JointEncoders(const EncoderModel& model, std::uint64_t seed) : model_(model), seed_(seed) {}
  JointPositions read(const JointPositions& truth) const;

 private:
  EncoderModel model_;
  std::uint64_t seed_;
};

}  // namespace rf::sim
