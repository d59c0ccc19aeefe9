// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include "values/frame.hpp"

namespace rf {

/// A frame as grabbed, or one that is lost.
struct GrabbedFrame {
  std::int64_t utime = 0;
  std::int64_t seq = 0;
  std::optional<RgbdFrame> frame;
  std::string problem;      ///< without a frame: why
  std::int64_t gap_us = 0;  ///< colour's time minus depth's
  std::chrono::steady_clock::time_point arrival;
};

/// From the grabbing thread to the encoding one. push never waits: when `capacity` frames wait
/// already, the oldest becomes a lost one, which keeps its number but not its images. Frames come
/// out in order. At most 256 lost ones are remembered; all are counted. Thread-safe.
class FrameQueue {
 public:
  explicit FrameQueue(std::size_t capacity) : capacity_(capacity) {}

  void push(GrabbedFrame frame);
  /// The oldest, or nothing within the timeout.
  std::optional<GrabbedFrame> pop(std::chrono::milliseconds timeout);
  /// Frames that were dropped because the reader was behind.
  std::int64_t dropped() const;
  std::size_t capacity() const { return capacity_; }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::deque<GrabbedFrame> items_;
  std::int64_t dropped_ = 0;
};

}  // namespace rf
