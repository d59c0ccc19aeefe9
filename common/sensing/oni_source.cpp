// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/oni_source.hpp"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "config/yaml.hpp"
#include "sensing/error.hpp"
#include "sensing/field_of_view.hpp"
#include "sensing/oni_times.hpp"
#include "sensing/pixels.hpp"

namespace rf {
namespace {

/// The player answers within milliseconds; a file that ends early never does.
constexpr int kTimeoutMs = 2000;
constexpr float kOnDemand = -1;
/// The player's thread reads on for a moment and would touch what is being destroyed.
constexpr auto kPlayerRest = std::chrono::milliseconds(200);

template <class T>
void turnRound(Image<T>& image) {
  for (int v = 0; v < image.height(); ++v) std::reverse(image.row(v), image.row(v) + image.width());
}

/// OpenNI2 gives its player's thread little time to end, cancels it, and unloads the driver that it
/// may still be in. So the driver stays in memory once it has played.
void keepPlayerLoaded() {
  std::string path;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* out) {
        const std::string name = info->dlpi_name;
        if (name.find("libOniFile") != std::string::npos) *static_cast<std::string*>(out) = name;
        return 0;
      },
      &path);
  if (!path.empty()) dlopen(path.c_str(), RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
}

const std::string& requireOniFile(const std::string& path) {
  if (!isOniFile(path)) throw SensingError(path + ": is no .oni recording");
  return path;
}

}  // namespace

bool isOniFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> magic{};
  file.read(magic.data(), magic.size());
  return file && std::string(magic.data(), magic.size()) == "NI10";
}

OniSource::OniSource(const std::string& path, double max_gap,
                     const std::optional<Camera>& calibration)
    : path_(requireOniFile(path)), pairer_(std::llround(max_gap * 1e6)) {
  keepPlayerLoaded();
  readTimes();
  requireOk(device_.open(path.c_str()), path + ": cannot be played");
  choosePlayback();
  openStream(depth_, openni::SENSOR_DEPTH, "depth");
  openStream(colour_, openni::SENSOR_COLOR, "colour");
  chooseCamera(calibration);
  mirrored_ = depth_.getMirroringEnabled();
  const openni::PlaybackControl& playback = *device_.getPlaybackControl();
  depth_count_ = playback.getNumberOfFrames(depth_);
  colour_count_ = playback.getNumberOfFrames(colour_);
  requireOk(depth_.start(), path + ": depth does not start");
  requireOk(colour_.start(), path + ": colour does not start");
}

OniSource::~OniSource() {
  depth_.stop();
  colour_.stop();
}

OniSource::PlayerRest::~PlayerRest() { std::this_thread::sleep_for(kPlayerRest); }

void OniSource::choosePlayback() {
  openni::PlaybackControl* playback = device_.getPlaybackControl();
  if (playback == nullptr) throw SensingError(path_ + ": OpenNI2 does not play it as a file");
  requireOk(playback->setRepeatEnabled(false), path_ + ": repeat cannot be switched off");
  requireOk(playback->setSpeed(kOnDemand), path_ + ": cannot be played frame by frame");
}

void OniSource::openStream(openni::VideoStream& stream, openni::SensorType type, const char* kind) {
  if (device_.getSensorInfo(type) == nullptr)
    throw SensingError(fmt::format("{}: has no {} stream", path_, kind));
  requireOk(stream.create(device_, type), fmt::format("{}: {} cannot be read", path_, kind));
}

void OniSource::chooseCamera(const std::optional<Camera>& calibration) {
  const openni::VideoMode depth = depth_.getVideoMode();
  const openni::VideoMode colour = colour_.getVideoMode();
  const int width = depth.getResolutionX();
  const int height = depth.getResolutionY();
  if (colour.getResolutionX() != width || colour.getResolutionY() != height) {
    throw SensingError(fmt::format("{}: depth is {}x{}, colour {}x{}: must be equal", path_, width,
                                   height, colour.getResolutionX(), colour.getResolutionY()));
  }
  try {
    camera_ = calibration ? *calibration
                          : cameraOfFieldOfView(width, height, colour_.getHorizontalFieldOfView(),
                                                colour_.getVerticalFieldOfView());
  } catch (const std::invalid_argument& e) {
    throw SensingError(path_ + ": " + e.what());
  }
  if (camera_.width != width || camera_.height != height) {
    throw SensingError(fmt::format("{}: images are {}x{}, the calibration is of {}x{}", path_,
                                   width, height, camera_.width, camera_.height));
  }
}

void OniSource::readTimes() {
  if (!std::filesystem::exists(timesFileOf(path_))) return;
  OniTimes times;
  loadConfigFile(timesFileOf(path_), times);
  depth_start_us_ = std::llround(times.depth_start_us);
  colour_start_us_ = std::llround(times.colour_start_us);
}

std::optional<SourcedFrame> OniSource::next() {
  while (ready_.empty() && !ended_) {
    if (readImage()) continue;
    ended_ = true;
    take(pairer_.finish());
  }
  if (ready_.empty()) return std::nullopt;
  SourcedFrame out = std::move(ready_.front());
  ready_.pop_front();
  return out;
}

bool OniSource::readImage() {
  const bool depth_done = depth_index_ >= depth_count_;
  const bool colour_done = colour_index_ >= colour_count_;
  if (depth_done && colour_done) return false;
  std::array<openni::VideoStream*, 2> streams = {&depth_, &colour_};
  int ready = -1;
  openni::VideoFrameRef frame;
  if (openni::OpenNI::waitForAnyStream(streams.data(), 2, &ready, kTimeoutMs) !=
          openni::STATUS_OK ||
      ready < 0 ||
      streams[static_cast<std::size_t>(ready)]->readFrame(&frame) != openni::STATUS_OK ||
      !frame.isValid())
    return false;
  const auto device_us = static_cast<std::int64_t>(frame.getTimestamp()) +
                         (ready == 0 ? depth_start_us_ : colour_start_us_);
  if (ready == 0) {
    depth_index_ = frame.getFrameIndex();
    auto depth = depthOf(frame, camera_.width, camera_.height);
    if (!depth) {
      ready_.push_back({device_us, next_seq_++, std::nullopt, path_ + ": " + depth.error});
      return true;
    }
    if (mirrored_) turnRound(*depth);
    take(pairer_.add(DepthImage{device_us, 0, std::move(*depth)}));
  } else {
    colour_index_ = frame.getFrameIndex();
    auto colour = colourOf(frame, camera_.width, camera_.height);
    if (!colour) return true;  // its depth image will say that it has no colour
    if (mirrored_) turnRound(*colour);
    take(pairer_.add(ColourImage{device_us, std::move(*colour)}));
  }
  return true;
}

void OniSource::take(std::vector<ImagePair> pairs) {
  for (ImagePair& pair : pairs) ready_.push_back(source(std::move(pair)));
}

SourcedFrame OniSource::source(ImagePair pair) {
  SourcedFrame out;
  out.utime = pair.depth.device_us;
  out.seq = next_seq_++;
  if (out.utime <= last_utime_) {
    out.problem = fmt::format("{}: time {} after {}: must increase", path_, out.utime, last_utime_);
    return out;
  }
  last_utime_ = out.utime;
  if (!pair.colour) {
    out.problem = fmt::format("{}: frame {}: {}", path_, out.seq, pair.problem);
    return out;
  }
  out.frame = RgbdFrame{out.utime, out.utime + pair.gap_us, out.seq, std::move(pair.colour->rgb),
                        std::move(pair.depth.mm)};
  return out;
}

}  // namespace rf
