// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "priors/planar_twist.hpp"
#include "priors/pose_buffer.hpp"
#include "priors/robot_config.hpp"
#include "priors/timeline.hpp"

namespace rf {

/// What an odometry message itself says of the base's velocity.
struct StatedSpeed {
  double speed = 0;  ///< m/s, not negative
  double turn = 0;   ///< rad/s, not negative
};

/// Motion of a robot's base from what its odometry sends: poses T_WB, planar twists, or increments.
/// Every add* returns what there is to say of the sample: why it was refused, or that it is a jump;
/// empty when all is well. Time offset and scales of the configuration are applied here. Not
/// thread-safe.
class BaseOdometry {
 public:
  BaseOdometry(const RobotConfig& config, double max_gap_s);

  /// A pose of the base in the odometry's world; with scales other than 1 its increments are
  /// scaled. A step that no base of max_speed and max_turn can make is a jump: accepted, but no
  /// motion across it is given.
  std::string addPose(std::int64_t utime, const SE3& T_WB, std::optional<StatedSpeed> stated = {});
  /// A twist measured at that time. Between two samples their mean holds (a constant twist gives an
  /// exact arc); over a gap longer than max_gap nothing is known. The first sample is the origin.
  std::string addTwist(std::int64_t utime, const PlanarTwist& twist);
  /// The motion since an earlier time: T_prev_now. Increments that do not join end to start (within
  /// 1 ms) leave a break.
  std::string addIncrement(std::int64_t from_utime, std::int64_t utime, const SE3& T_prev_now);
  void reserve(std::size_t samples) { poses_.reserve(samples); }

  /// The base's pose at a time, as PoseBuffer::at.
  PoseAt at(std::int64_t utime, double max_gap_s, double max_extrapolation_s) const;
  /// Why the motion from a to b must not be used although both poses are known: a jump between, or
  /// odometry that stands still while it says itself that it moves. Empty when it may.
  std::string flaw(std::int64_t a, std::int64_t b) const;
  /// How long the pose has not changed at b, when it has not changed since a either.
  std::optional<double> stillFor(std::int64_t a, std::int64_t b) const;
  bool covers(std::int64_t utime) const { return !poses_.empty() && poses_.newest() >= utime; }
  const SourceCounts& counts() const { return counts_; }
  /// Times of the samples at hand, the configuration's offset applied.
  std::vector<std::int64_t> times() const;

 private:
  struct Mark {
    std::int64_t utime = 0;
    std::int64_t unchanged_since = 0;
    StatedSpeed stated;
  };
  std::int64_t shifted(std::int64_t utime) const;
  std::string refuse(std::string why);
  /// Judges the time; fills `said` and returns false when the sample is to be refused.
  bool takeTime(std::int64_t utime, std::string& said);
  std::string push(std::int64_t utime, const SE3& step, StatedSpeed stated, bool joined);
  void forget();
  const Mark* markAt(std::int64_t utime) const;

  RobotConfig config_;
  double max_gap_s_;
  PoseBuffer poses_;
  Timeline timeline_;
  Breaks breaks_;
  std::deque<Mark> marks_;
  std::optional<StampedPose> last_raw_;  ///< as received
  std::optional<StampedPose> last_;      ///< as given
  std::optional<PlanarTwist> last_twist_;
  SourceCounts counts_;
};

}  // namespace rf
