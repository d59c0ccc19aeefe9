// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "messaging/lockstep_gate.hpp"
#include "messaging/service.hpp"
#include "pipeline/codec.hpp"
#include "values/frame_source.hpp"

namespace rf {

struct CaptureOptions {
  std::string channel = "OPENNI_FRAME";
  LockstepOptions lockstep;
  double speed = 1;  ///< live: times the recorded rate; 0: as fast as possible
};

/// Publishes the frames of a recording: calibration, frame and tick. Live it keeps the recorded
/// rate; in lockstep it sends frame k+1 when RF_MODEL_STATE of frame k has arrived, and sends frame
/// k again when that takes too long.
class CaptureNode {
 public:
  CaptureNode(Service& service, std::unique_ptr<FrameSource> source, const CodecOptions& codec,
              const CaptureOptions& options, bool lockstep, std::string source_name);

  void awaitServices() { gate_.awaitServices(); }
  /// Sends everything, or until it is stopped. Throws as LockstepGate::awaitResult.
  void play();

 private:
  using Clock = std::chrono::steady_clock;
  /// A frame ready to be sent, or the tick of one that is lost.
  struct Prepared {
    FrameTick tick;
    Bytes frame;
    double ms = 0;
  };

  std::optional<Prepared> prepare();
  void prefetch();
  void sendCamera();
  void refreshCamera();
  bool sendFrame(const Prepared& prepared);
  void step(const Prepared& prepared);
  void pace(std::int64_t utime);

  Service& service_;
  std::unique_ptr<FrameSource> source_;
  CodecOptions codec_;
  CaptureOptions options_;
  bool lockstep_;
  std::string source_name_;
  LockstepGate gate_;
  std::future<std::optional<Prepared>> next_;
  Clock::time_point camera_sent_;
  Clock::time_point play_start_;
  std::optional<std::int64_t> first_utime_;
  std::int64_t last_utime_ = 0;
  std::int64_t last_seq_ = -1;
};

}  // namespace rf
