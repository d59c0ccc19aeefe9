// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinematics/robot_model.hpp"
#include "priors/timeline.hpp"
#include "values/motion_prior.hpp"

namespace rf {

/// Joint positions looked up at a time.
struct JointsAt {
  PriorState state = PriorState::kMissing;
  JointPositions q;    ///< means nothing when missing
  std::string reason;  ///< why it is not kValid; empty when it is
};

/// Positions of the joints that a robot's chains need, in increasing time, one track per joint: a
/// robot may send arm and head in different messages. Not thread-safe.
class JointBuffer {
 public:
  /// Takes joints of these names, others are passed over. At most `capacity` samples per joint.
  JointBuffer(const std::map<std::string, JointKind>& wanted, double max_speed, double offset_s,
              std::size_t capacity = 20000);

  /// Wheels: no speed of these is a jump.
  void allowAnySpeed(std::span<const std::string> joints);

  /// Takes what is wanted of a message. Returns what there is to say: nothing wanted in it, numbers
  /// that are not finite, time that does not advance, jumps; empty when all is well.
  std::string add(std::int64_t utime, std::span<const std::string> names,
                  std::span<const double> positions);
  void reserve(std::size_t capacity);

  /// The positions at a time, joint by joint as PoseBuffer::at does for poses: linear between
  /// neighbours at most `max_gap_s` apart (continuous joints the short way round), constant
  /// velocity up to `max_extrapolation_s` beyond the ends, else missing. Every joint must be a
  /// wanted one.
  JointsAt at(std::int64_t utime, std::span<const std::string> joints, double max_gap_s,
              double max_extrapolation_s) const;
  /// Why the motion of these joints from a to b must not be used: a jump between. Empty when it
  /// may.
  std::string flaw(std::int64_t a, std::int64_t b, std::span<const std::string> joints) const;
  /// True when each of the joints has a sample at or after that time.
  bool covers(std::int64_t utime, std::span<const std::string> joints) const;
  /// Those of the wanted joints that never had a sample.
  std::vector<std::string> unseen() const;
  const SourceCounts& counts() const { return counts_; }

 private:
  struct Sample {
    std::int64_t utime = 0;
    double position = 0;  ///< continuous joints unwound
  };
  struct Track {
    JointKind kind = JointKind::kRevolute;
    bool any_speed = false;
    std::deque<Sample> samples;
    Timeline timeline;
    Breaks breaks;
  };
  struct PositionAt {
    PriorState state = PriorState::kMissing;
    double position = 0;
    std::string reason;
  };
  std::string addOne(const std::string& name, Track& track, std::int64_t utime, double position);
  static PositionAt lookUp(const Track& track, std::int64_t utime, double max_gap_s,
                           double max_extrapolation_s);

  std::map<std::string, Track> tracks_;
  double max_speed_;
  std::int64_t offset_us_;
  std::size_t capacity_;
  SourceCounts counts_;
};

}  // namespace rf
