// SPDX-License-Identifier: BSD-3-Clause
// An OpenNI2 driver without a device: what it shows and how it fails is told by commands (rig.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <OniCTypes.h>

// The kit's own header for these is not part of the package.
#define XN_NEW(type, argument) new type(argument)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>

#include "rig.hpp"

namespace rf {
namespace {

constexpr int kMaxDepth = 10000;
constexpr int kLargestFrame = 1280 * 1024 * 3;
/// The Xtion's fields of view, radians.
constexpr float kHorizontalFov = 1.0225999F;
constexpr float kVerticalFov = 0.79661566F;

std::array<OniVideoMode, 3> modesOf(OniPixelFormat format) {
  return {OniVideoMode{format, 640, 480, 30}, {format, 320, 240, 30}, {format, 320, 240, 60}};
}

std::array<OniVideoMode, 3> g_depth_modes = modesOf(ONI_PIXEL_FORMAT_DEPTH_1_MM);
std::array<OniVideoMode, 3> g_colour_modes = modesOf(ONI_PIXEL_FORMAT_RGB888);

bool same(const OniVideoMode& a, const OniVideoMode& b) {
  return a.pixelFormat == b.pixelFormat && a.resolutionX == b.resolutionX &&
         a.resolutionY == b.resolutionY && a.fps == b.fps;
}

template <class T>
OniStatus give(const T& value, void* data, int* size) {
  if (*size != static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, &value, sizeof(T));
  return ONI_STATUS_OK;
}

template <class T>
bool takeValue(T& value, const void* data, int size) {
  if (size != static_cast<int>(sizeof(T))) return false;
  std::memcpy(&value, data, sizeof(T));
  return true;
}

class TestStream : public oni::driver::StreamBase, public RigStream {
 public:
  TestStream(Rig& rig, OniSensorType type)
      : rig_(rig),
        depth_(type == ONI_SENSOR_DEPTH),
        mode_((depth_ ? g_depth_modes : g_colour_modes)[0]) {
    rig_.add(this);
  }
  ~TestStream() override { rig_.remove(this); }
  TestStream(const TestStream&) = delete;
  TestStream& operator=(const TestStream&) = delete;

  OniStatus start() override {
    started_ = true;
    return ONI_STATUS_OK;
  }
  void stop() override { started_ = false; }
  int getRequiredFrameSize() override { return kLargestFrame; }

  OniBool isPropertySupported(int id) override {
    std::array<char, 64> buffer{};
    int size = sizeOf(id);
    return getProperty(id, buffer.data(), &size) == ONI_STATUS_OK ? TRUE : FALSE;
  }

  OniStatus getProperty(int id, void* data, int* size) override {
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return give(mode_, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return give(kHorizontalFov, data, size);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return give(kVerticalFov, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return give(mirror_, data, size);
      case ONI_STREAM_PROPERTY_CROPPING:
        return give(OniCropping{}, data, size);
      case ONI_STREAM_PROPERTY_STRIDE:
        return give(stride(), data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return depth_ ? give(kMaxDepth, data, size) : ONI_STATUS_NOT_SUPPORTED;
      case ONI_STREAM_PROPERTY_MIN_VALUE:
        return depth_ ? give(0, data, size) : ONI_STATUS_NOT_SUPPORTED;
      case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
      case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
      case ONI_STREAM_PROPERTY_EXPOSURE:
        return depth_ ? ONI_STATUS_NOT_SUPPORTED : give(0, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  OniStatus setProperty(int id, const void* data, int size) override {
    const std::string kind = depth_ ? "depth_" : "colour_";
    OniBool flag = FALSE;
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return setMode(data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        if (!takeValue(mirror_, data, size)) return ONI_STATUS_BAD_PARAMETER;
        rig_.note(kind + "mirror", mirror_);
        return ONI_STATUS_OK;
      case ONI_STREAM_PROPERTY_AUTO_EXPOSURE:
        if (depth_ || !takeValue(flag, data, size)) return ONI_STATUS_BAD_PARAMETER;
        rig_.note("auto_exposure", flag);
        return ONI_STATUS_OK;
      case ONI_STREAM_PROPERTY_AUTO_WHITE_BALANCE:
        if (depth_ || !takeValue(flag, data, size)) return ONI_STATUS_BAD_PARAMETER;
        rig_.note("auto_white_balance", flag);
        return ONI_STATUS_OK;
      case ONI_STREAM_PROPERTY_EXPOSURE:
        if (depth_ || !takeValue(flag, data, size)) return ONI_STATUS_BAD_PARAMETER;
        rig_.note("exposure", flag);
        return ONI_STATUS_OK;
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }

  /// A recorder asks for these, so that they stand in the file.
  void notifyAllProperties() override {
    raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &mode_, sizeof(mode_));
    raisePropertyChanged(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &kHorizontalFov, sizeof(float));
    raisePropertyChanged(ONI_STREAM_PROPERTY_VERTICAL_FOV, &kVerticalFov, sizeof(float));
    raisePropertyChanged(ONI_STREAM_PROPERTY_MIRRORING, &mirror_, sizeof(mirror_));
    // Without these two the player of .oni files shows nothing.
    const OniCropping whole{};
    const int bytes = stride();
    raisePropertyChanged(ONI_STREAM_PROPERTY_CROPPING, &whole, sizeof(whole));
    raisePropertyChanged(ONI_STREAM_PROPERTY_STRIDE, &bytes, sizeof(bytes));
    if (depth_) raisePropertyChanged(ONI_STREAM_PROPERTY_MAX_VALUE, &kMaxDepth, sizeof(int));
  }

  bool isDepth() const override { return depth_; }
  int width() const override { return mode_.resolutionX; }
  int height() const override { return mode_.resolutionY; }

  void deliver(const RgbdFrame& whole, int width, int height) override {
    if (!started_) return;
    const bool other = width > 0 && height > 0;
    const RgbdFrame odd = other ? patternFrame(0, width, height) : RgbdFrame{};
    const RgbdFrame& shown = other ? odd : whole;
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    frame->sensorType = depth_ ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR;
    frame->videoMode = mode_;
    frame->width = shown.depth_mm.width();
    frame->height = shown.depth_mm.height();
    frame->frameIndex = static_cast<int>(whole.seq) + 1;  // lost images leave gaps
    frame->timestamp = static_cast<std::uint64_t>(depth_ ? whole.utime : whole.colour_utime);
    frame->croppingEnabled = FALSE;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->stride = frame->width * (depth_ ? 2 : 3);
    frame->dataSize = frame->stride * frame->height;
    std::memcpy(frame->data,
                depth_ ? static_cast<const void*>(shown.depth_mm.data())
                       : static_cast<const void*>(shown.colour.data()),
                static_cast<std::size_t>(frame->dataSize));
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

 private:
  static int sizeOf(int id) {
    if (id == ONI_STREAM_PROPERTY_VIDEO_MODE) return static_cast<int>(sizeof(OniVideoMode));
    return id == ONI_STREAM_PROPERTY_CROPPING ? static_cast<int>(sizeof(OniCropping)) : 4;
  }
  int stride() const { return mode_.resolutionX * (depth_ ? 2 : 3); }

  OniStatus setMode(const void* data, int size) {
    OniVideoMode wanted{};
    if (!takeValue(wanted, data, size) || rig_.refuses("modes")) return ONI_STATUS_BAD_PARAMETER;
    const auto& modes = depth_ ? g_depth_modes : g_colour_modes;
    if (std::none_of(modes.begin(), modes.end(), [&](const auto& m) { return same(m, wanted); }))
      return ONI_STATUS_BAD_PARAMETER;
    mode_ = wanted;
    return ONI_STATUS_OK;
  }

  Rig& rig_;
  bool depth_;
  OniVideoMode mode_;
  OniBool mirror_ = TRUE;
  std::atomic<bool> started_{false};
};

class TestDevice : public oni::driver::DeviceBase {
 public:
  explicit TestDevice(Rig& rig) : rig_(rig) {}

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = sensors_.data();
    *count = static_cast<int>(sensors_.size());
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return new TestStream(rig_, type);
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return give(registration_, data, size);
    if (id != ONI_DEVICE_PROPERTY_SERIAL_NUMBER) return ONI_STATUS_NOT_SUPPORTED;
    static constexpr char kSerial[] = "RF-TEST-1";
    if (*size < static_cast<int>(sizeof(kSerial))) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, kSerial, sizeof(kSerial));
    *size = sizeof(kSerial);
    return ONI_STATUS_OK;
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    if (!takeValue(registration_, data, size)) return ONI_STATUS_BAD_PARAMETER;
    rig_.note("registration", registration_);
    return ONI_STATUS_OK;
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER
               ? TRUE
               : FALSE;
  }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || !rig_.refuses("registration") ? TRUE : FALSE;
  }

 private:
  Rig& rig_;
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  std::array<OniSensorInfo, 2> sensors_ = {
      OniSensorInfo{ONI_SENSOR_DEPTH, static_cast<int>(g_depth_modes.size()), g_depth_modes.data()},
      OniSensorInfo{ONI_SENSOR_COLOR, static_cast<int>(g_colour_modes.size()),
                    g_colour_modes.data()}};
};

class TestDriver : public oni::driver::DriverBase {
 public:
  explicit TestDriver(OniDriverServices* services) : DriverBase(services), rig_(Rig::instance()) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    if (rig_.connected()) announce(true);
    rig_.attach([this] { announce(false); });
    return ONI_STATUS_OK;
  }
  void shutdown() override { rig_.attach({}); }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    if (!rig_.connected() || rig_.refuses("open") || rig_.uri() != uri) return nullptr;
    return new TestDevice(rig_);
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }

  void* enableFrameSync(oni::driver::StreamBase** /*streams*/, int count) override {
    rig_.note("sync", count);
    return this;
  }
  void disableFrameSync(void* /*group*/) override { rig_.note("sync", 0); }

 private:
  void announce(bool connected) {
    OniDeviceInfo info{};
    if (connected) announced_ = rig_.uri();
    std::strncpy(info.uri, announced_.c_str(), sizeof(info.uri) - 1);
    std::strncpy(info.vendor, "RigidFusion", sizeof(info.vendor) - 1);
    std::strncpy(info.name, "Test sensor", sizeof(info.name) - 1);
    if (connected) {
      deviceConnected(&info);
    } else {
      deviceDisconnected(&info);
    }
  }

  Rig& rig_;
  std::string announced_;
};

}  // namespace
}  // namespace rf

// NOLINTBEGIN: OpenNI2's own macro
using RfTestDriver = rf::TestDriver;
ONI_EXPORT_DRIVER(RfTestDriver)
// NOLINTEND

/// For tests in the same process: obeys; empty, or what was not understood.
extern "C" __attribute__((visibility("default"))) const char* rfTestDriverCommand(
    const char* text) {
  static thread_local std::string faults;
  faults = rf::Rig::instance().command(text);
  return faults.c_str();
}

/// What the driver was asked for: "auto_exposure=0 colour_mirror=0 ...".
extern "C" __attribute__((visibility("default"))) const char* rfTestDriverNotes() {
  static thread_local std::string notes;
  notes = rf::Rig::instance().notes();
  return notes.c_str();
}
