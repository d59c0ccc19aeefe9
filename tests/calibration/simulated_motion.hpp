// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "calibration/calibrate.hpp"

namespace rf::calibration::testing {

/// How a base drives: its speed v(t) and turning w(t) in the plane.
enum class Drive {
  kLively,     ///< starts, stops, both directions of turning
  kStraight,   ///< speeds up and slows down on a line
  kOnTheSpot,  ///< turns to and fro without driving
  kSteady,     ///< one speed on a line
};

/// What the sensors do wrong.
struct DriveNoise {
  double seen_position = 0.002;        ///< m, each pose
  double seen_rotation = 0.0015;       ///< rad, each pose
  double drift_position = 0.005;       ///< m/sqrt(s), random walk of the seen poses
  double drift_rotation = 0.0015;      ///< rad/sqrt(s)
  double slip_distance = 0.005;        ///< m/sqrt(m) along the way; across: 0.4 of it
  double slip_heading = 0.006;         ///< rad/sqrt(rad)
  double slip_heading_by_way = 0.005;  ///< rad/sqrt(m)
  static DriveNoise none() { return {0, 0, 0, 0, 0, 0, 0}; }
};

struct Recording {
  Trajectory A, X;
  CalibrationValues truth;
};

/// A base with a camera. Without noise the odometry is exact between its poses as well: the base
/// keeps its twist for 20 ms. Odometry at 50 Hz, camera at 30 Hz.
Recording simulateDrive(Drive drive, const CalibrationValues& truth, double seconds,
                        const DriveNoise& noise, std::uint64_t seed);

/// How an arm moves its hand.
enum class Reach {
  kFree,     ///< turns about all axes
  kPlanar,   ///< turns about one axis and moves across it
  kSliding,  ///< moves without turning
};

/// An arm with a camera in its hand, poses of the hand at 100 Hz with errors of the joints, camera
/// at 30 Hz with those of DriveNoise.
Recording simulateArm(Reach reach, const CalibrationValues& truth, double seconds,
                      double joint_noise, const DriveNoise& noise, std::uint64_t seed);

/// An arm that holds an object before a camera, both in the camera's frame. The object's pose errs
/// at random and, `lasting` m (and rad / 2), over about 2 s.
Recording simulateGrasp(const CalibrationValues& truth, double seconds, double joint_noise,
                        double alone, double lasting, std::uint64_t seed);

/// A camera in front of the base, 0.9 m up, looking ahead and down.
SE3 someCamera();
/// A transform between hand and camera or object.
SE3 someGrip();
/// The values changed by normal errors of the prior's standard deviations in the asked groups.
CalibrationPrior priorAround(const CalibrationValues& truth, const CalibrationPrior& sigmas,
                             const std::vector<ParameterGroup>& wrong, std::uint64_t seed);

}  // namespace rf::calibration::testing
