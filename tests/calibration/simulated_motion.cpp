// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/path.hpp"
#include "simulation/random.hpp"

namespace rf::calibration::testing {
namespace {

constexpr double kBegin = 1000.0;  ///< s; recordings do not start at zero
constexpr double kLead = 0.5;      ///< s that A's record is longer at either end

std::int64_t micros(double t) { return std::llround(1e6 * (kBegin + t)); }

Vec6 noiseTwist(sim::Random* random, double translation, double rotation) {
  Vec6 xi;
  for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? translation : rotation) * random->normal();
  return xi;
}

/// Rises smoothly from 0 to 1 over the second after `start`.
double ramp(double t, double start) {
  const double s = std::clamp(t - start, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

Vec6 driveTwist(Drive drive, double t) {
  Vec6 twist = Vec6::Zero();
  const double wave = std::sin(0.9 * t) + 0.5 * std::sin(0.37 * t + 1);
  if (drive == Drive::kLively) {
    // Eight seconds of driving, one of rest.
    const double phase = std::fmod(t + 100, 9.0);
    const double go = ramp(phase, 0) * (1 - ramp(phase, 7));
    twist[0] = go * (0.35 + 0.15 * std::sin(0.7 * t));
    twist[5] = go * 0.8 * wave;
  }
  if (drive == Drive::kStraight) twist[0] = 0.4 + 0.3 * std::sin(0.8 * t);
  if (drive == Drive::kSteady) twist[0] = 0.4;
  if (drive == Drive::kOnTheSpot) twist[5] = 0.8 * std::sin(0.8 * t);
  return twist;
}

Vec6 reachTwist(Reach reach, double t) {
  Vec6 twist;
  twist << 0.2 * std::sin(0.9 * t), 0.15 * std::sin(1.1 * t + 1), 0.1 * std::sin(0.7 * t + 2),
      0.5 * std::sin(0.8 * t + 0.5), 0.6 * std::sin(1.2 * t), 0.5 * std::sin(0.6 * t + 1);
  if (reach == Reach::kSliding) twist.tail<3>().setZero();
  if (reach == Reach::kPlanar) twist[2] = twist[3] = twist[4] = 0;
  return twist;
}

/// Integrates a twist that is kept for `step` seconds, from -kLead on.
template <class Twist>
Trajectory integrate(double seconds, double step, const SE3& first, const Twist& twist) {
  Trajectory out;
  SE3 pose = first;
  const auto count = static_cast<int>(std::ceil((seconds + 2 * kLead) / step));
  for (int i = 0; i <= count; ++i) {
    const double t = -kLead + i * step;
    out.push_back({micros(t), pose});
    pose = pose * SE3::exp(step * twist(t));
  }
  return out;
}

/// Poses at `rate` of a body at T_AX on the true path, as seen: drifting and noisy.
Trajectory seen(const Path& truth, const SE3& T_AX, double seconds, double rate,
                const DriveNoise& noise, sim::Random* random) {
  Trajectory out;
  SE3 drifted;
  SE3 before;
  for (int i = 0; i <= static_cast<int>(seconds * rate); ++i) {
    const double t = static_cast<double>(micros(i / rate) - micros(0)) * 1e-6;
    const SE3 pose = truth.at(t) * T_AX;
    const double root = std::sqrt(1 / rate);
    drifted = i == 0 ? SE3()
                     : drifted * (before.inverse() * pose) *
                           SE3::exp(noiseTwist(random, noise.drift_position * root,
                                               noise.drift_rotation * root));
    before = pose;
    out.push_back({micros(t), drifted * SE3::exp(noiseTwist(random, noise.seen_position,
                                                            noise.seen_rotation))});
  }
  return out;
}

/// A's record of a true motion: stamps on its own clock, steps scaled and slipping.
Trajectory wheels(const Path& truth, const CalibrationValues& values, double seconds,
                  const DriveNoise& noise, sim::Random* random) {
  Trajectory out;
  SE3 pose;
  const auto offset = std::llround(1e6 * values.time_offset);
  SE3 before = truth.at(-kLead);
  for (int i = 0; i <= static_cast<int>(std::lround((seconds + 2 * kLead) / 0.02)); ++i) {
    const double t = -kLead + 0.02 * i;
    const SE3 now = truth.at(t);
    Vec6 step = (before.inverse() * now).log();
    before = now;
    const double way = std::sqrt(step.head<3>().norm());
    const double angle = std::sqrt(step.tail<3>().norm());
    step.head<3>() /= values.translation_scale;
    step.tail<3>() /= values.rotation_scale;
    step[0] += noise.slip_distance * way * random->normal();
    step[1] += 0.4 * noise.slip_distance * way * random->normal();
    step[5] += noise.slip_heading * angle * random->normal();
    step[5] += noise.slip_heading_by_way * way * random->normal();
    pose = pose * SE3::exp(step);
    out.push_back({micros(t) - offset, pose});
  }
  return out;
}

Trajectory hands(const Path& truth, const CalibrationValues& values, double seconds,
                 double joint_noise, sim::Random* random) {
  Trajectory out;
  const auto offset = std::llround(1e6 * values.time_offset);
  for (int i = 0; i <= static_cast<int>(std::lround((seconds + 2 * kLead) / 0.01)); ++i) {
    const double t = -kLead + 0.01 * i;
    const SE3 pose = truth.at(t) * SE3::exp(noiseTwist(random, 0.5 * joint_noise, joint_noise));
    out.push_back({micros(t) - offset, pose});
  }
  return out;
}

SE3 transform(double x, double y, double z, double roll, double pitch, double yaw) {
  const Eigen::Quaterniond q = Eigen::AngleAxisd(yaw, Vec3::UnitZ()) *
                               Eigen::AngleAxisd(pitch, Vec3::UnitY()) *
                               Eigen::AngleAxisd(roll, Vec3::UnitX());
  return {q, Vec3(x, y, z)};
}

}  // namespace

Recording simulateDrive(Drive drive, const CalibrationValues& truth, double seconds,
                        const DriveNoise& noise, std::uint64_t seed) {
  sim::Random random(seed, 11);
  const double shift = 20 * random.uniform();  // another part of the drive for each seed
  const Path path(integrate(seconds, 0.02, transform(1, 2, 0, 0, 0, 0.5),
                            [&](double t) { return driveTwist(drive, t + shift); }),
                  micros(0), "truth");
  Recording out;
  out.truth = truth;
  out.A = wheels(path, truth, seconds, noise, &random);
  out.X = seen(path, truth.T_AX, seconds, 30, noise, &random);
  return out;
}

Recording simulateArm(Reach reach, const CalibrationValues& truth, double seconds,
                      double joint_noise, const DriveNoise& noise, std::uint64_t seed) {
  sim::Random random(seed, 12);
  const double shift = 20 * random.uniform();
  const Path path(integrate(seconds, 0.01, transform(0.5, 0, 0.8, 0, 0.3, 0),
                            [&](double t) { return reachTwist(reach, t + shift); }),
                  micros(0), "truth");
  Recording out;
  out.truth = truth;
  out.A = hands(path, truth, seconds, joint_noise, &random);
  out.X = seen(path, truth.T_AX, seconds, 30, noise, &random);
  return out;
}

Recording simulateGrasp(const CalibrationValues& truth, double seconds, double joint_noise,
                        double alone, double lasting, std::uint64_t seed) {
  sim::Random random(seed, 13);
  const double shift = 20 * random.uniform();
  const Path path(integrate(seconds, 0.01, transform(0, 0.2, 1.2, 0, 0.3, 0),
                            [&](double t) { return reachTwist(Reach::kFree, t + shift); }),
                  micros(0), "truth");
  Recording out;
  out.truth = truth;
  out.A = hands(path, truth, seconds, joint_noise, &random);
  const double memory = std::exp(-1.0 / 30 / 2.0);
  Vec6 slow = noiseTwist(&random, lasting, 0.5 * lasting);
  for (int i = 0; i <= static_cast<int>(seconds * 30); ++i) {
    const double t = static_cast<double>(micros(i / 30.0) - micros(0)) * 1e-6;
    const double fresh = std::sqrt(1 - memory * memory);
    if (i > 0) slow = memory * slow + fresh * noiseTwist(&random, lasting, 0.5 * lasting);
    const SE3 error = SE3::exp(slow + noiseTwist(&random, alone, 0.5 * alone));
    out.X.push_back({micros(t), path.at(t) * truth.T_AX * error});
  }
  return out;
}

SE3 someCamera() {
  // Optical axes: z ahead, x right, y down.
  const SE3 optical = transform(0, 0, 0, -std::numbers::pi / 2, 0, -std::numbers::pi / 2);
  return transform(0.25, -0.08, 0.9, 0, 0.3, 0.1) * optical;
}

SE3 someGrip() { return transform(0.04, -0.06, 0.12, 0.4, -0.3, 1.2); }

CalibrationPrior priorAround(const CalibrationValues& truth, const CalibrationPrior& sigmas,
                             const std::vector<ParameterGroup>& wrong, std::uint64_t seed) {
  sim::Random random(seed, 14);
  ParameterVector delta = ParameterVector::Zero();
  for (int k = 0; k < kParameters; ++k) delta[k] = sigmas.sigmas()[k] * random.normal();
  ParameterVector kept = ParameterVector::Zero();
  for (const ParameterGroup g : wrong) {
    const ParameterMask mask = maskOf(g);
    for (int k = 0; k < kParameters; ++k) {
      if (mask[static_cast<std::size_t>(k)]) kept[k] = delta[k];
    }
  }
  CalibrationPrior prior = sigmas;
  prior.values = plus(truth, kept);
  return prior;
}

}  // namespace rf::calibration::testing
