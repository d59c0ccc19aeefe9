// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "values/stamped_pose.hpp"

namespace rf {

/// An estimated pose and the true pose of the same moment.
struct PosePair {
  std::int64_t utime = 0;  ///< of the estimate
  SE3 estimate;
  SE3 truth;
};

/// Statistics of a list of non-negative errors; all zero for an empty list.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0;
  double mean = 0;
  double median = 0;
  double max = 0;
};
ErrorStatistics statistics(std::vector<double> errors);

/// Pairs each estimate with the nearest true pose at most `max_difference_us` away, one-to-one, the
/// closest first, as the TUM tools do. Both in increasing time; the result too.
std::vector<PosePair> matchPoses(const Trajectory& estimate, const Trajectory& truth,
                                 std::int64_t max_difference_us = 20000);

/// Absolute trajectory error: |t_truth - t_(S estimate)| over all pairs, metres. Translations only.
ErrorStatistics absoluteError(const std::vector<PosePair>& pairs, const SE3& S = SE3());

/// The transform S that puts the first estimate onto its truth: S est_0 = truth_0.
/// Identity when there is no pair.
SE3 alignFirstPose(const std::vector<PosePair>& pairs);

/// The rigid transform S that minimises the sum of |t_truth - S t_estimate|^2 (Horn, Umeyama
/// without scale). With fewer than three pairs only the means are aligned.
SE3 alignPositions(const std::vector<PosePair>& pairs);

/// Relative pose error over `delta_s` seconds: for each pose the one that is nearest to delta_s
/// later (at most `tolerance_s` off, and not where the trajectory ends before, else there is no
/// such pair), error E = (truth_i^-1 truth_j)^-1 (est_i^-1 est_j): |t_E| in metres, the angle of E
/// in radians.
struct RelativeError {
  ErrorStatistics translation;
  ErrorStatistics rotation;
};
RelativeError relativeError(const std::vector<PosePair>& pairs, double delta_s = 1.0,
                            double tolerance_s = 0.025);

/// All numbers of one trajectory.
struct TrajectoryScore {
  ErrorStatistics ate_first;    ///< metres, aligned at the first pose
  ErrorStatistics ate_aligned;  ///< metres, SE(3)-aligned
  RelativeError rpe;            ///< over 1 s: metres and radians
  std::size_t frames = 0;       ///< input frames
  std::size_t posed = 0;        ///< input frames that have a pose
  std::size_t matched = 0;      ///< poses that found a truth
  double coverage = 0;          ///< posed / frames
};

/// The camera: the estimate is aligned on the left. `frames`: utimes of the input frames,
/// increasing.
TrajectoryScore scoreCamera(const Trajectory& estimate, const Trajectory& truth,
                            const std::vector<std::int64_t>& frames);

/// The object: `world` brings the estimate's world into the truth's (the camera's first-pose
/// alignment, or identity); the object frame's constant offset is removed at the first pose: world
/// T_WO_est(t) X with X from the first pair. ate_aligned adds an SE(3) alignment on the left.
TrajectoryScore scoreObject(const Trajectory& estimate, const Trajectory& truth,
                            const std::vector<std::int64_t>& frames, const SE3& world);

/// The offset X: (world est_0) X = truth_0. Nothing without a pair.
std::optional<SE3> objectOffset(const Trajectory& estimate, const Trajectory& truth,
                                const SE3& world);

/// Speed of each pose's origin by central differences over `half_window` poses to either side
/// (one-sided at the ends), m/s; 0 for a single pose.
std::vector<double> speeds(const Trajectory& trajectory, std::size_t half_window = 1);

}  // namespace rf
