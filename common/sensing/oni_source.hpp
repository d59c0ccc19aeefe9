// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <deque>
#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "sensing/openni_session.hpp"
#include "sensing/pairing.hpp"
#include "values/frame_source.hpp"

namespace rf {

/// True when the file begins as .oni files do.
bool isOniFile(const std::string& path);

/// A .oni recording, frame by frame, each one in order however slowly they are asked for: every
/// depth image with the colour image nearest in time. utime is the device's time stamp; OpenNI2
/// records it from 0 on for each stream, and what rf-capture wrote beside the file (OniTimes) makes
/// it whole. Images that were recorded mirrored are turned round. A depth image without colour
/// within `max_gap` seconds is given with the reason. One of these at a time in a process; OpenNI2
/// plays in a thread of its own.
class OniSource : public FrameSource {
 public:
  /// The camera is `calibration`, else that of the recorded field of view. Throws SensingError when
  /// the file cannot be played, lacks a stream, both differ in size, the calibration is of another
  /// size, or there is no calibration.
  OniSource(const std::string& path, double max_gap,
            const std::optional<Camera>& calibration = std::nullopt);
  ~OniSource() override;
  OniSource(const OniSource&) = delete;
  OniSource& operator=(const OniSource&) = delete;

  const Camera& camera() const override { return camera_; }
  std::size_t size() const override { return static_cast<std::size_t>(depth_count_); }
  std::optional<SourcedFrame> next() override;

 private:
  void openStream(openni::VideoStream& stream, openni::SensorType type, const char* kind);
  void choosePlayback();
  void readTimes();
  void chooseCamera(const std::optional<Camera>& calibration);
  /// Reads one image of either stream. False at the end.
  bool readImage();
  void take(std::vector<ImagePair> pairs);
  SourcedFrame source(ImagePair pair);

  std::string path_;
  OpenniSession session_;
  openni::Device device_;
  openni::VideoStream depth_, colour_;
  /// Before the streams go, also when the constructor throws: OpenNI2 2.2 does not wait for its
  /// player.
  struct PlayerRest {
    PlayerRest() = default;
    ~PlayerRest();
    PlayerRest(const PlayerRest&) = delete;
    PlayerRest& operator=(const PlayerRest&) = delete;
  } rest_;
  Camera camera_;
  bool mirrored_ = false;
  int depth_count_ = 0, colour_count_ = 0;  ///< images in the file
  std::int64_t depth_start_us_ = 0, colour_start_us_ = 0;
  int depth_index_ = 0, colour_index_ = 0;  ///< of the last one read, from 1
  FramePairer pairer_;
  std::deque<SourcedFrame> ready_;
  std::int64_t next_seq_ = 0;
  std::int64_t last_utime_ = -1;
  bool ended_ = false;
};

}  // namespace rf
