// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "values/motion_prior.hpp"
#include "values/stamped_pose.hpp"

namespace rf {

/// What became of a pose that was offered.
enum class PoseVerdict {
  kAccepted,
  kNotFinite,  ///< NaN or infinity
  kNotUnit,    ///< quaternion further than 1e-2 from unit length
  kNotLater,   ///< time not after the newest pose
};

/// How many poses met which fate.
struct PoseCounts {
  std::int64_t accepted = 0;
  std::int64_t not_finite = 0;
  std::int64_t not_unit = 0;
  std::int64_t not_later = 0;
  std::int64_t evicted = 0;  ///< oldest poses that gave way to new ones
};

/// A pose looked up at a time.
struct PoseAt {
  PriorState state = PriorState::kMissing;
  SE3 pose;            ///< means nothing when missing
  std::string reason;  ///< why it is not kValid; empty when it is
};

/// Poses of one source in increasing time, at most `capacity` of them.
class PoseBuffer {
 public:
  explicit PoseBuffer(std::size_t capacity = 100000);

  /// Takes the pose, its quaternion normalised, or says and counts why not.
  PoseVerdict add(std::int64_t utime, const SE3& pose);
  /// Room for that many poses at least; a file is loaded whole.
  void reserve(std::size_t capacity);
  void clear();

  bool empty() const { return poses_.empty(); }
  std::size_t size() const { return poses_.size(); }
  /// Times of the oldest and newest pose; only when not empty.
  std::int64_t oldest() const { return poses_.front().utime; }
  std::int64_t newest() const { return poses_.back().utime; }
  const PoseCounts& counts() const { return counts_; }

  /// The pose at a time: on the geodesic between its neighbours when they are at most `max_gap_s`
  /// apart; up to `max_extrapolation_s` beyond either end at the velocity of the two poses there
  /// (kExtrapolated); else kMissing with the reason.
  PoseAt at(std::int64_t utime, double max_gap_s, double max_extrapolation_s) const;

 private:
  PoseAt beyond(std::int64_t utime, double max_gap_s, double max_extrapolation_s) const;

  std::size_t capacity_;
  std::deque<StampedPose> poses_;
  PoseCounts counts_;
};

}  // namespace rf
