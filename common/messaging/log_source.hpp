// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "messaging/log_file.hpp"
#include "pipeline/codec.hpp"
#include "values/frame_source.hpp"

namespace rf {

/// The frames of an LCM log: bot_core.images_t on one channel, ours or openni2-camera-lcm's.
/// Repeated frames (lockstep's resends) are skipped; undecodable ones and such whose time does not
/// increase or whose size is not the camera's are given with the reason.
class LcmLogSource : public FrameSource {
 public:
  /// The camera is `calibration`, else the log's first RF_CAMERA. Throws DatasetError when
  /// the file cannot be opened, holds no frame, or there is no calibration.
  LcmLogSource(const std::string& path, const std::optional<Camera>& calibration = std::nullopt,
               const std::string& channel = "OPENNI_FRAME");

  const Camera& camera() const override { return camera_; }
  std::size_t size() const override { return frames_; }
  std::optional<SourcedFrame> next() override;
  /// The frame that next() gave last, as it stands in the log.
  const EncodedFrame& encoded() const { return encoded_; }
  /// Empty, or what was wrong with the file (damage, truncated tail).
  std::string damage() const;

 private:
  void scan(const std::string& path);
  SourcedFrame unpackFrame(const LogEvent& event);

  LogReader reader_;
  std::string channel_;
  Camera camera_;
  bool calibrated_ = false;
  std::size_t frames_ = 0;
  std::int64_t last_utime_ = -1;
  std::int64_t counted_ = 0;
  EncodedFrame encoded_;
};

}  // namespace rf
