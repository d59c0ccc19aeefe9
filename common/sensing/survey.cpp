// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/survey.hpp"

#include <array>

#include <fmt/format.h>

#include "sensing/error.hpp"
#include "sensing/openni_session.hpp"
#include "sensing/pixels.hpp"

namespace rf {
namespace {

std::string serialOf(const openni::Device& device) {
  std::array<char, 256> text{};
  int size = static_cast<int>(text.size()) - 1;
  const auto status = device.getProperty(openni::DEVICE_PROPERTY_SERIAL_NUMBER, text.data(), &size);
  return status == openni::STATUS_OK && text[0] != '\0' ? text.data() : "unknown";
}

std::string modesOf(const openni::SensorInfo& sensor) {
  std::string text;
  const auto& modes = sensor.getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    const openni::VideoMode& m = modes[i];
    text +=
        fmt::format("      {}{}x{}@{} {}\n", rankOf(m.getPixelFormat()) < 0 ? "! " : "",
                    m.getResolutionX(), m.getResolutionY(), m.getFps(), nameOf(m.getPixelFormat()));
  }
  return text;
}

std::string fieldOfView(openni::Device& device, openni::SensorType type) {
  openni::VideoStream stream;
  if (stream.create(device, type) != openni::STATUS_OK) return "cannot be made";
  return fmt::format("field of view {:.4f} x {:.4f} rad", stream.getHorizontalFieldOfView(),
                     stream.getVerticalFieldOfView());
}

std::string describe(const DeviceName& name) {
  std::string text = fmt::format("{}\n    {} {} [{:04x}:{:04x}]\n", name.uri, name.vendor,
                                 name.name, name.usb_vendor, name.usb_product);
  openni::Device device;
  try {
    requireOk(device.open(name.uri.c_str()), "    cannot be opened");
  } catch (const SensingError& e) {
    return text + e.what() + "\n";
  }
  text += fmt::format(
      "    serial {}, registration of depth to colour: {}\n", serialOf(device),
      device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR) ? "yes"
                                                                                         : "no");
  for (const auto& [type, kind] :
       {std::pair(openni::SENSOR_DEPTH, "depth"), std::pair(openni::SENSOR_COLOR, "colour")}) {
    const openni::SensorInfo* sensor = device.getSensorInfo(type);
    text += sensor == nullptr ? fmt::format("    {}: none\n", kind)
                              : fmt::format("    {}: {}, modes\n{}", kind,
                                            fieldOfView(device, type), modesOf(*sensor));
  }
  device.close();
  return text;
}

}  // namespace

std::string surveyDevices() {
  const OpenniSession session;
  std::string text;
  for (const DeviceName& name : connectedDevices()) text += describe(name);
  return text;
}

}  // namespace rf
