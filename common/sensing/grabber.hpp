// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sensing/device.hpp"
#include "sensing/device_clock.hpp"
#include "sensing/frame_queue.hpp"
#include "sensing/pairing.hpp"

namespace rf {

struct GrabOptions {
  std::string device = "any";  ///< or a URI
  DeviceConfig config;
  std::optional<Camera> calibration;  ///< nothing: the device's own
  std::string record;                 ///< .oni file, empty: none
  bool wait = false;                  ///< no device at the start is no error
  std::function<std::int64_t()> now;  ///< system time, microseconds since the epoch
};

/// What the grabbing thread has done and how it is.
struct GrabStatus {
  bool connected = false;
  std::string text;  ///< device, or what is being waited for
  std::int64_t depth_images = 0, colour_images = 0;
  std::int64_t frames = 0;    ///< pairs that were handed on
  std::int64_t unpaired = 0;  ///< depth images without colour near in time
  std::int64_t bad = 0;       ///< images of a wrong size or format
  std::int64_t dropped = 0;   ///< frames that the reader was too slow for
  std::int64_t openings = 0;  ///< how often the device was opened; one more than it came back
  double drift_ppm = 0;       ///< of system time against the device's clock
  int clock_jumps = 0;
};

/// Grabs from an OpenNI2 device in a thread of its own, pairs colour and depth, maps time stamps to
/// system time, and finds the device again when it is unplugged and plugged in. Numbers run on over
/// that; utime increases strictly. The thread never waits for the reader.
class Grabber {
 public:
  /// Opens the device. Throws SensingError when there is none (unless `wait`) or it cannot be used
  /// as configured, std::invalid_argument when the calibration is of another size.
  explicit Grabber(GrabOptions options);
  ~Grabber();
  Grabber(const Grabber&) = delete;
  Grabber& operator=(const Grabber&) = delete;

  /// The oldest frame that waits, or nothing within the timeout.
  std::optional<GrabbedFrame> next(std::chrono::milliseconds timeout) {
    return queue_.pop(timeout);
  }
  /// The camera of the frames; nothing before a device without calibration file was found.
  std::optional<Camera> camera() const;
  GrabStatus status() const;
  /// What should be said once: refused settings, clock jumps, reconnects. Empties the list.
  std::vector<std::string> takeNotes();

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  /// False when there is no device; throws SensingError when there is one that cannot be used.
  bool open();
  void reopen();
  void close(const std::string& why);
  void count(std::int64_t GrabStatus::*what);
  void grab();
  void closeWhenSilent();
  void drop(const BadImage& bad, std::int64_t arrival_us);
  void hand(ImagePair pair);
  void handLost(std::int64_t utime, const std::string& why);
  std::int64_t stamp(std::int64_t device_us, std::int64_t arrival_us);
  void say(const std::string& note);
  std::string recordFile() const;

  GrabOptions options_;
  FrameQueue queue_;
  std::string wanted_;  ///< the URI to look for, or "any"
  std::unique_ptr<OpenniSession> session_;
  std::unique_ptr<OpenniDevice> device_;
  std::optional<FramePairer> pairer_;
  std::optional<DeviceClock> clock_;
  Clock::time_point last_image_;
  std::int64_t next_seq_ = 0;
  std::int64_t last_utime_ = 0;
  std::string last_bad_;  ///< said already

  mutable std::mutex mutex_;  ///< of what follows
  GrabStatus status_;
  std::optional<Camera> camera_;
  std::vector<std::string> notes_;
  std::condition_variable wake_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace rf
