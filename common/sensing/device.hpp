// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "geometry/camera.hpp"
#include "sensing/device_config.hpp"
#include "sensing/openni_session.hpp"
#include "sensing/pairing.hpp"

namespace rf {

/// An image that cannot be used, and why.
struct BadImage {
  std::int64_t device_us = 0;
  bool is_depth = false;
  std::string problem;
};

/// What came: nothing in time, a depth or colour image (arrival_us not set), or one to be dropped.
using DeviceImage = std::variant<std::monostate, DepthImage, ColourImage, BadImage>;

/// An open OpenNI2 device with a depth and a colour stream, set up as configured. One thread reads.
class OpenniDevice {
 public:
  /// Opens and configures; no images yet. Throws SensingError naming device, setting and rule when
  /// it cannot be opened, lacks a sensor, mode or registration, or refuses a setting that the
  /// pipeline cannot do without. Needs a session that outlives it.
  OpenniDevice(const DeviceName& name, const DeviceConfig& config);
  ~OpenniDevice();
  OpenniDevice(const OpenniDevice&) = delete;
  OpenniDevice& operator=(const OpenniDevice&) = delete;

  const DeviceName& name() const { return name_; }
  /// Settings that it does not have or refused and that the pipeline can do without.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// From the field of view that the device reports: the colour camera's when depth is registered
  /// to it. Throws SensingError when the device reports none that is usable.
  Camera factoryCamera() const;

  /// Before start: everything that comes, from the first image on, is also written to this file,
  /// and what OpenNI2 forgets of its times beside it (OniTimes). Throws SensingError.
  void record(const std::string& file);
  /// Images come from now on. Throws SensingError.
  void start();
  /// The next image of either stream, or nothing within the timeout.
  DeviceImage read(std::chrono::milliseconds timeout);
  /// OpenNI2 says that it is unplugged.
  bool gone() const { return gone_.load(); }

 private:
  class Unplugged : public openni::OpenNI::DeviceDisconnectedListener {
   public:
    explicit Unplugged(OpenniDevice& device) : device_(device) {}
    void onDeviceDisconnected(const openni::DeviceInfo* info) override;

   private:
    OpenniDevice& device_;
  };

  void openStream(openni::VideoStream& stream, openni::SensorType type, const char* kind);
  void configureDevice();
  void configureColour();
  void wish(openni::Status status, const std::string& setting);
  void startRecorder();
  void noteTime(bool is_depth, std::int64_t device_us);

  DeviceName name_;
  DeviceConfig config_;
  std::vector<std::string> warnings_;
  std::atomic<bool> gone_{false};
  Unplugged unplugged_;
  openni::Device device_;
  openni::VideoStream depth_;
  openni::VideoStream colour_;
  openni::Recorder recorder_;
  std::string record_file_;
  std::optional<std::int64_t> first_depth_us_, first_colour_us_;
};

}  // namespace rf
