// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "values/motion_prior.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// What a frame is, given the frames taken before it.
enum class FrameKind {
  kNew,       ///< later than every frame before
  kRepeated,  ///< the newest frame once more: the sender misses its result
  kOld,       ///< an earlier frame once more: nothing to do
  kRestart,   ///< the stream began anew: forget everything
};

/// Orders the frames of a stream by utime; seq (-1: not counted) only helps to tell a restart.
class StreamOrder {
 public:
  FrameKind judge(std::int64_t utime, std::int64_t seq) const;
  /// The frame was taken. Returns the number of frames that seq says are missing before it.
  std::int64_t accept(std::int64_t utime, std::int64_t seq);
  void reset();
  std::optional<std::int64_t> lastUtime() const;
  std::int64_t lastSeq() const { return last_seq_; }

 private:
  static constexpr std::size_t kMemory = 512;
  std::deque<std::int64_t> recent_;
  std::int64_t last_seq_ = -1;
};

/// Priors as they arrive, to be asked for any pair of frames: those of frames that were skipped in
/// between are composed.
class PriorChain {
 public:
  void add(const MotionPrior& prior);
  /// The prior of (utime_a, utime_b), or nothing while a link is missing. utime_a = utime_b asks
  /// for the first frame's. Links older than utime_b stay, so that a repeated question gets the
  /// same answer.
  std::optional<MotionPrior> find(std::int64_t utime_a, std::int64_t utime_b) const;
  /// The prior whose frame B is at this time, whatever its frame A.
  std::optional<MotionPrior> endingAt(std::int64_t utime_b) const;
  /// Forgets links that end before this time.
  void forgetBefore(std::int64_t utime);
  void clear() { by_end_.clear(); }

 private:
  static constexpr std::size_t kMemory = 512;
  std::map<std::int64_t, MotionPrior> by_end_;
};

/// A prior that says: nothing is known of this pair.
MotionPrior missingPrior(std::int64_t utime_a, std::int64_t utime_b, std::int64_t seq);

/// `link` for a receiver to whom its frame B is the first: no increment, the absolute pose stays.
MotionPrior firstFramePrior(const MotionPrior& link);

/// `next` with the motions of `skipped`, the result just before it whose frame fusion never got,
/// put before its own: the motions then refer to skipped's frame A. Covariances add to first order.
SegmentationResult composeSegmentations(const SegmentationResult& skipped,
                                        const SegmentationResult& next);

}  // namespace rf
