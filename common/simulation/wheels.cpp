// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/wheels.hpp"

#include <cmath>
#include <numbers>

#include "simulation/random.hpp"

namespace rf::sim {
namespace {

/// Where a wheel stands and how its rollers lie: its rim runs at vx + side * vy + turn * wz.
struct Wheel {
  double side, turn;
};

std::vector<Wheel> wheelsOf(const Manipulator& robot, const WheelModel& m) {
  if (!robot.omnidirectional) return {{0, -m.half_track}, {0, m.half_track}};
  const double L = m.half_track + m.half_base;
  return {{-1, -L}, {1, L}, {1, -L}, {-1, L}};  // front left, right, rear left, right
}

/// The base's way that fits the wheels' best; sideways only when it can.
PlanarTwist solve(const std::vector<Wheel>& wheels, const std::vector<double>& rim) {
  PlanarTwist out;
  double side2 = 0;
  double turn2 = 0;
  for (std::size_t i = 0; i < wheels.size(); ++i) {
    out.vx += rim[i] / static_cast<double>(wheels.size());
    out.vy += wheels[i].side * rim[i];
    out.wz += wheels[i].turn * rim[i];
    side2 += wheels[i].side * wheels[i].side;
    turn2 += wheels[i].turn * wheels[i].turn;
  }
  out.vy = side2 > 0 ? out.vy / side2 : 0.0;
  out.wz /= turn2;
  return out;
}

/// One wheel's errors and its encoder.
class WheelState {
 public:
  WheelState(const WheelModel& model, std::uint64_t seed, std::size_t index)
      : model_(model), random_(seed, 0x33EE1ULL + index) {
    scale_ = model.scale_sigma * random_.normal();
    slip_ = model.slip_sigma * random_.normal();
  }

  /// The rim goes `way` metres in `seconds`; gives what the encoder counts, metres.
  double roll(double way, double seconds) {
    const double keep = std::exp(-seconds / model_.slip_memory);
    slip_ = keep * slip_ + std::sqrt(1 - keep * keep) * model_.slip_sigma * random_.normal();
    if (random_.chance(model_.spins_per_s * seconds)) spin_left_ = model_.spin_seconds;
    const double spin = spin_left_ > 0 ? model_.spin_share : 0.0;
    spin_left_ -= seconds;
    turned_ += way * (1 + scale_ + slip_ + spin);
    const double tick = 2 * std::numbers::pi * model_.radius / model_.ticks;
    const double count = std::floor(turned_ / tick);
    const double counted = (count - last_count_) * tick;
    last_count_ = count;
    return counted;
  }

 private:
  WheelModel model_;
  Random random_;
  double scale_ = 0, slip_ = 0, spin_left_ = 0, turned_ = 0, last_count_ = 0;
};

}  // namespace

std::vector<WheelPose> wheelOdometry(const Manipulator& robot, const WheelModel& model,
                                     double begin, double end, double rate, std::uint64_t seed) {
  const std::vector<Wheel> wheels = wheelsOf(robot, model);
  std::vector<WheelState> states;
  for (std::size_t i = 0; i < wheels.size(); ++i) states.emplace_back(model, seed, i);
  const double step = 1 / rate;
  std::vector<WheelPose> out = {{begin, robot.base_at(begin)}};
  for (int k = 1; begin + k * step <= end + 1e-9; ++k) {
    const PlanarTwist v = robot.twist_at(begin + (k - 0.5) * step);
    std::vector<double> rim;
    for (std::size_t i = 0; i < wheels.size(); ++i) {
      const double speed = v.vx + wheels[i].side * v.vy + wheels[i].turn * v.wz;
      rim.push_back(states[i].roll(speed * step, step));
    }
    SE3 next = out.back().T_WB * planarStep(solve(wheels, rim), 1.0);
    next.q.normalize();
    out.push_back({begin + k * step, next});
  }
  return out;
}

}  // namespace rf::sim
