// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/log_source.hpp"

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "messaging/conversions.hpp"

namespace rf {
namespace {

LogReader openLog(const std::string& path) {
  try {
    return LogReader(path);
  } catch (const std::runtime_error& e) {
    throw DatasetError(e.what());
  }
}

}  // namespace

LcmLogSource::LcmLogSource(const std::string& path, const std::optional<Camera>& calibration,
                           const std::string& channel)
    : reader_(openLog(path)), channel_(channel) {
  if (calibration) {
    camera_ = *calibration;
    calibrated_ = true;
  }
  scan(path);
}

void LcmLogSource::scan(const std::string& path) {
  LogReader reader(path);
  while (const auto event = reader.next()) {
    if (event->channel == channel_) ++frames_;
    if (calibrated_ || event->channel != "RF_CAMERA") continue;
    if (const auto info = unpack<rigidfusion::camera_t>(event->data)) {
      camera_ = info->camera;
      calibrated_ = true;
    }
  }
  if (frames_ == 0) throw DatasetError(path + ": no message on channel " + channel_);
  if (!calibrated_) {
    throw DatasetError(path + ": no RF_CAMERA in the log; give the calibration with --calibration");
  }
}

std::optional<SourcedFrame> LcmLogSource::next() {
  while (const auto event = reader_.next()) {
    if (event->channel != channel_) continue;
    SourcedFrame out = unpackFrame(*event);
    if (out.problem.empty() && out.utime == last_utime_) continue;
    if (out.problem.empty() && out.utime < last_utime_) {
      out.frame.reset();
      out.problem = fmt::format("{}: utime {} after {}: time must increase", channel_, out.utime,
                                last_utime_);
    }
    if (out.frame) last_utime_ = out.utime;
    counted_ = out.seq + 1;
    return out;
  }
  return std::nullopt;
}

SourcedFrame LcmLogSource::unpackFrame(const LogEvent& event) {
  SourcedFrame out;
  out.coded = true;
  out.utime = event.utime;
  out.seq = counted_;
  auto encoded = unpack<bot_core::images_t>(event.data);
  if (!encoded) {
    out.problem = channel_ + ": " + encoded.error;
    return out;
  }
  encoded_ = std::move(*encoded);
  if (encoded_.seq < 0) encoded_.seq = counted_;
  out.utime = encoded_.utime;
  out.seq = encoded_.seq;
  auto frame = decode(encoded_);
  if (!frame) {
    out.problem = channel_ + ": " + frame.error;
  } else if (frame->depth_mm.width() != camera_.width ||
             frame->depth_mm.height() != camera_.height) {
    out.problem =
        fmt::format("{}: the frame is {}x{}, the camera {}x{}", channel_, frame->depth_mm.width(),
                    frame->depth_mm.height(), camera_.width, camera_.height);
  } else {
    out.frame = std::move(*frame);
  }
  return out;
}

std::string LcmLogSource::damage() const {
  if (reader_.damages() > 0) {
    return fmt::format("{} damaged places, {} bytes skipped", reader_.damages(),
                       reader_.skippedBytes());
  }
  return reader_.truncated() ? "the last event is incomplete" : "";
}

}  // namespace rf
