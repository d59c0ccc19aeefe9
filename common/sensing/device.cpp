// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/device.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "config/yaml.hpp"
#include "sensing/error.hpp"
#include "sensing/field_of_view.hpp"
#include "sensing/oni_times.hpp"
#include "sensing/pixels.hpp"

namespace rf {
namespace {

constexpr auto kRecorderStart = std::chrono::seconds(5);
constexpr auto kRecorderRest = std::chrono::milliseconds(100);

std::string modeList(const openni::Array<openni::VideoMode>& modes) {
  std::string text;
  for (int i = 0; i < modes.getSize(); ++i) {
    const openni::VideoMode& m = modes[i];
    if (rankOf(m.getPixelFormat()) < 0) continue;
    const std::string one =
        fmt::format("{}x{}@{}", m.getResolutionX(), m.getResolutionY(), m.getFps());
    if (text.find(one) == std::string::npos) text += (text.empty() ? "" : ", ") + one;
  }
  return text.empty() ? "none that is usable" : text;
}

/// The mode of the configured size and rate in the best format, or nothing.
const openni::VideoMode* findMode(const openni::Array<openni::VideoMode>& modes,
                                  const DeviceConfig& config) {
  const openni::VideoMode* best = nullptr;
  for (int i = 0; i < modes.getSize(); ++i) {
    const openni::VideoMode& m = modes[i];
    const int rank = rankOf(m.getPixelFormat());
    if (rank < 0 || m.getResolutionX() != config.width || m.getResolutionY() != config.height ||
        m.getFps() != config.fps)
      continue;
    if (best == nullptr || rank < rankOf(best->getPixelFormat())) best = &m;
  }
  return best;
}

}  // namespace

void OpenniDevice::Unplugged::onDeviceDisconnected(const openni::DeviceInfo* info) {
  if (info != nullptr && device_.name_.uri == info->getUri()) device_.gone_ = true;
}

OpenniDevice::OpenniDevice(const DeviceName& name, const DeviceConfig& config)
    : name_(name), config_(config), unplugged_(*this) {
  requireOk(device_.open(name.uri.c_str()),
            fmt::format("device {}: cannot be opened (used by another program, or no right to "
                        "write to it: see the udev rule of libopenni2-0)",
                        name.uri));
  openStream(depth_, openni::SENSOR_DEPTH, "depth");
  openStream(colour_, openni::SENSOR_COLOR, "colour");
  configureDevice();
  openni::OpenNI::addDeviceDisconnectedListener(&unplugged_);
}

OpenniDevice::~OpenniDevice() {
  openni::OpenNI::removeDeviceDisconnectedListener(&unplugged_);
  recorder_.stop();
  recorder_.destroy();
  for (openni::VideoStream* stream : {&depth_, &colour_}) {
    stream->stop();
    stream->destroy();
  }
  device_.close();
}

void OpenniDevice::openStream(openni::VideoStream& stream, openni::SensorType type,
                              const char* kind) {
  const openni::SensorInfo* sensor = device_.getSensorInfo(type);
  if (sensor == nullptr)
    throw SensingError(fmt::format("device {}: has no {} sensor", name_.uri, kind));
  const auto& modes = sensor->getSupportedVideoModes();
  const openni::VideoMode* mode = findMode(modes, config_);
  if (mode == nullptr) {
    throw SensingError(fmt::format(
        "device {}: {} of {}x{}@{} (capture.device.width, height, fps): the device has {}",
        name_.uri, kind, config_.width, config_.height, config_.fps, modeList(modes)));
  }
  const std::string what = fmt::format("device {}: {}", name_.uri, kind);
  requireOk(stream.create(device_, type), what + " stream cannot be made");
  requireOk(stream.setVideoMode(*mode),
            fmt::format("{} of {}x{}@{}", what, config_.width, config_.height, config_.fps));
  const openni::Status mirrored = stream.setMirroringEnabled(config_.mirror);
  if (stream.getMirroringEnabled() != config_.mirror)
    requireOk(mirrored == openni::STATUS_OK ? openni::STATUS_ERROR : mirrored,
              fmt::format("{}: mirror = {} is refused", what, config_.mirror));
}

void OpenniDevice::configureDevice() {
  if (config_.registration) {
    constexpr auto kToColour = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (!device_.isImageRegistrationModeSupported(kToColour)) {
      throw SensingError(
          fmt::format("device {}: cannot register depth to colour; when its depth is registered as "
                      "it comes, set "
                      "capture.device.registration=false",
                      name_.uri));
    }
    requireOk(device_.setImageRegistrationMode(kToColour),
              fmt::format("device {}: registration of depth to colour", name_.uri));
  }
}

void OpenniDevice::wish(openni::Status status, const std::string& setting) {
  if (status != openni::STATUS_OK)
    warnings_.push_back(
        fmt::format("device {}: {} cannot be set; it stays as it is", name_.uri, setting));
}

void OpenniDevice::configureColour() {
  openni::CameraSettings* settings = colour_.getCameraSettings();
  if (settings == nullptr) {
    warnings_.push_back(
        fmt::format("device {}: has no settings of exposure and white balance", name_.uri));
    return;
  }
  wish(settings->setAutoExposureEnabled(config_.auto_exposure), "auto_exposure");
  if (!config_.auto_exposure && config_.exposure > 0)
    wish(settings->setExposure(config_.exposure), "exposure");
  wish(settings->setAutoWhiteBalanceEnabled(config_.auto_white_balance), "auto_white_balance");
}

Camera OpenniDevice::factoryCamera() const {
  const openni::VideoStream& seen_from = config_.registration ? colour_ : depth_;
  try {
    return cameraOfFieldOfView(config_.width, config_.height, seen_from.getHorizontalFieldOfView(),
                               seen_from.getVerticalFieldOfView());
  } catch (const std::invalid_argument& e) {
    throw SensingError(fmt::format("device {}: {}", name_.uri, e.what()));
  }
}

void OpenniDevice::record(const std::string& file) {
  requireOk(recorder_.create(file.c_str()), file + ": cannot be recorded to");
  requireOk(recorder_.attach(depth_, false), file + ": depth cannot be recorded");
  requireOk(recorder_.attach(colour_, config_.record_lossy_colour),
            file + ": colour cannot be recorded");
  record_file_ = file;
}

void OpenniDevice::startRecorder() {
  requireOk(recorder_.start(), record_file_ + ": recording does not start");
  // It starts in a thread of its own and takes images once it has written the file's head: the file
  // has grown, and grows no more.
  const auto until = std::chrono::steady_clock::now() + kRecorderStart;
  auto changed = std::chrono::steady_clock::now();
  std::uintmax_t size = 0;
  while (size == 0 || std::chrono::steady_clock::now() - changed < kRecorderRest) {
    if (std::chrono::steady_clock::now() > until)
      throw SensingError(record_file_ + ": nothing is written to it; is the disk full?");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::error_code error;
    const auto now = std::filesystem::file_size(record_file_, error);
    if (error || now == size) continue;
    size = now;
    changed = std::chrono::steady_clock::now();
  }
}

void OpenniDevice::noteTime(bool is_depth, std::int64_t device_us) {
  auto& first = is_depth ? first_depth_us_ : first_colour_us_;
  if (first || record_file_.empty()) return;
  first = device_us;
  if (!first_depth_us_ || !first_colour_us_) return;
  std::ofstream(timesFileOf(record_file_)) << writeConfig(
      OniTimes{static_cast<double>(*first_depth_us_), static_cast<double>(*first_colour_us_)});
}

void OpenniDevice::start() {
  if (recorder_.isValid()) startRecorder();
  requireOk(depth_.start(), fmt::format("device {}: depth does not start", name_.uri));
  requireOk(colour_.start(), fmt::format("device {}: colour does not start", name_.uri));
  // Only now: settings before a stream runs are lost, and only running streams are synchronised.
  wish(device_.setDepthColorSyncEnabled(config_.sync), "sync");
  configureColour();
}

DeviceImage OpenniDevice::read(std::chrono::milliseconds timeout) {
  std::array<openni::VideoStream*, 2> streams = {&depth_, &colour_};
  int ready = -1;
  if (openni::OpenNI::waitForAnyStream(streams.data(), 2, &ready,
                                       static_cast<int>(timeout.count())) != openni::STATUS_OK ||
      ready < 0)
    return {};
  openni::VideoFrameRef frame;
  if (streams[static_cast<std::size_t>(ready)]->readFrame(&frame) != openni::STATUS_OK ||
      !frame.isValid())
    return {};
  const auto device_us = static_cast<std::int64_t>(frame.getTimestamp());
  noteTime(ready == 0, device_us);
  if (ready == 0) {
    auto depth = depthOf(frame, config_.width, config_.height);
    if (!depth) return BadImage{device_us, true, depth.error};
    return DepthImage{device_us, 0, std::move(*depth)};
  }
  auto colour = colourOf(frame, config_.width, config_.height);
  if (!colour) return BadImage{device_us, false, colour.error};
  return ColourImage{device_us, std::move(*colour)};
}

}  // namespace rf
