// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "scene.hpp"

namespace rf {

/// What the rig calls on a stream that was created.
class RigStream {
 public:
  virtual ~RigStream() = default;
  virtual bool isDepth() const = 0;
  /// Hands the frame to OpenNI when the stream is started. `width`, `height`: 0 = as the mode says.
  virtual void deliver(const RgbdFrame& frame, int width, int height) = 0;
  virtual int width() const = 0;
  virtual int height() const = 0;
};

/// The imagined sensor behind the test driver. It outlives the driver, which OpenNI creates and
/// destroys at will, and does what it is told, one command a line or between semicolons:
///   frames N         deliver the next N depth and colour images, then return
///   free HZ          deliver at this rate until `hold` (or the end of the scene)
///   hold             stop that
///   drop depth|colour N     the next N images of this kind are lost
///   late colour N    the next N colour images are held back until `release`
///   size depth|colour W H   deliver this size whatever the mode says; 0 0: as it says
///   jump US          device time jumps
///   disconnect       the plug is pulled
///   connect [URI]    the plug is in again, maybe elsewhere
///   refuse modes|registration|open on|off
///   scene DIR        show a TUM-layout folder
/// Commands come from the environment (RF_TEST_DRIVER), a fifo (RF_TEST_DRIVER_FIFO), and
/// rfTestDriverCommand.
class Rig {
 public:
  static Rig& instance();
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  /// Empty, or what is wrong with the commands.
  std::string command(const std::string& text);

  bool connected() const { return connected_; }
  std::string uri() const;
  bool refuses(const std::string& what) const;
  /// How to tell the driver that is loaded now that the plug was pulled; or nothing.
  void attach(std::function<void()> unplugged);
  void add(RigStream* stream);
  void remove(RigStream* stream);
  /// What the driver was asked for, as "name=value" words in the order of names.
  void note(const std::string& name, long value);
  std::string notes() const;

 private:
  struct Stream {
    int drop = 0;
    int late = 0;
    int width = 0, height = 0;  ///< of what is delivered; 0 = as the mode says
  };

  Rig();
  std::string obey(const std::string& line);
  std::string disturb(const std::string& verb, std::istream& words);
  void step();
  void deliver(const RgbdFrame& frame, bool depth);
  void runFree(double hertz);
  void stopFree();
  void readFifo(const std::string& path);
  void setConnected(bool connected);

  std::mutex command_mutex_;  ///< one command at a time
  mutable std::mutex mutex_;  ///< of what follows
  std::string uri_ = "rftest/0001@1/2";
  std::set<std::string> refused_;
  std::vector<std::pair<std::string, long>> notes_;
  std::function<void()> announce_;
  std::unique_ptr<DriverScene> scene_;
  std::atomic<bool> connected_{true};

  std::mutex streams_mutex_;  ///< held while frames are delivered
  std::vector<RigStream*> streams_;
  Stream depth_, colour_;
  std::vector<RgbdFrame> held_colour_;
  int next_ = 0;
  std::int64_t offset_us_ = 0;

  std::thread free_;
  std::mutex free_mutex_;
  std::condition_variable free_wake_;
  bool free_stop_ = false;
};

}  // namespace rf
