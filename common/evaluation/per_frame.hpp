// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/segmentation_score.hpp"
#include "evaluation/trajectory_error.hpp"

namespace rf {

/// What truth and result say of one input frame; what one of them lacks is absent.
struct FrameScore {
  std::int64_t utime = 0;
  std::optional<double> object_speed;         ///< true, of the object's origin, m/s
  std::optional<double> object_displacement;  ///< true, metres from where it rested last
  std::optional<double> dynamic_share;        ///< of the pixels whose true class is known
  std::optional<PixelCounts> pixels;          ///< absent when the frame has no true mask
  std::optional<double> camera_error;         ///< metres, aligned at the first pose
  std::optional<double> object_error;         ///< metres, as scoreObject aligns
};

/// Both trajectories of one body in one world, with what brings the estimate onto the truth:
/// left * estimate * right.
struct AlignedTrajectory {
  const Trajectory& estimate;
  const Trajectory& truth;
  SE3 left;
  SE3 right;
};

/// Distance of the body's origin from its place at the last rest (speed below `rest_speed`, m/s),
/// for each pose, metres; 0 while it rests. A body that moves from the first pose on is measured
/// from there.
std::vector<double> displacementsSinceRest(const Trajectory& truth, double rest_speed);

/// Frames with their poses' errors and the object's true motion; `pixels` and `dynamic_share` are
/// left to the caller. `frames`: utimes, increasing. A pose belongs to a frame of the same utime, a
/// true pose to the frame nearest to it, at most 20 ms away.
std::vector<FrameScore> scoreFrames(const std::vector<std::int64_t>& frames,
                                    const AlignedTrajectory& camera,
                                    const AlignedTrajectory& object, double rest_speed);

/// Share of the dynamic class among the known pixels of a true mask (0 unknown, 1 static, 2
/// dynamic, 3 the robot itself); 0 when none is known.
double dynamicShare(const Image<std::uint8_t>& truth);

/// CSV with a header row: timestamp (s), then the members in order with the unit in the name; an
/// absent value is an empty cell. `iou`, the two accuracies and the four counts come from `pixels`.
std::string toCsv(const std::vector<FrameScore>& frames);

}  // namespace rf
