// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "geometry/se3.hpp"
#include "priors/timeline.hpp"

namespace rf {

/// From `utime` on the object is held at T_GO in the gripper, or not held.
struct Grasp {
  std::int64_t utime = 0;
  bool held = false;
  SE3 T_GO;  ///< object -> gripper; means nothing when not held
};

/// Which object pose in the gripper holds when. Not thread-safe.
class GraspTimeline {
 public:
  explicit GraspTimeline(double offset_s);

  /// Takes an event, or says why not (not finite, not a unit quaternion, older than the newest). An
  /// event more than 1 s older than the newest begins the timeline anew from there: the clock went
  /// back. Repeating what holds already changes nothing.
  std::string add(const Grasp& grasp);

  struct Held {
    bool held = false;
    SE3 T_GO;
    std::string reason;  ///< why not; empty when held
  };
  /// The grasp that holds from a to b (a <= b) without a change between.
  Held between(std::int64_t a, std::int64_t b) const;
  const SourceCounts& counts() const { return counts_; }

 private:
  static constexpr std::size_t kMost = 100000;
  std::deque<Grasp> events_;
  std::int64_t newest_ = 0;  ///< of all that were taken, repetitions included
  std::int64_t offset_us_;
  SourceCounts counts_;
};

}  // namespace rf
