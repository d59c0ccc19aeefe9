// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/openni_session.hpp"

#include <algorithm>

#include "sensing/error.hpp"

namespace rf {
namespace {

std::string trimmed(const char* text) {
  std::string out = text == nullptr ? "" : text;
  while (!out.empty() && std::isspace(static_cast<unsigned char>(out.back()))) out.pop_back();
  std::replace(out.begin(), out.end(), '\n', ';');
  return out;
}

std::string kindOf(const std::string& uri) {
  const auto at = uri.find('@');
  return at == std::string::npos ? std::string() : uri.substr(0, at);
}

}  // namespace

void requireOk(openni::Status status, const std::string& what) {
  if (status == openni::STATUS_OK) return;
  const std::string why = trimmed(openni::OpenNI::getExtendedError());
  throw SensingError(what +
                     ": OpenNI2 says: " + (why.empty() ? "error " + std::to_string(status) : why));
}

OpenniSession::OpenniSession() {
  const openni::Status status = openni::OpenNI::initialize();
  if (status == openni::STATUS_OK) return;
  const std::string why = trimmed(openni::OpenNI::getExtendedError());
  openni::OpenNI::shutdown();
  throw SensingError("OpenNI2 cannot be started: " + (why.empty() ? "no reason given" : why) +
                     "; its drivers are in the package libopenni2-0");
}

OpenniSession::~OpenniSession() { openni::OpenNI::shutdown(); }

std::vector<DeviceName> connectedDevices() {
  openni::Array<openni::DeviceInfo> list;
  openni::OpenNI::enumerateDevices(&list);
  std::vector<DeviceName> out;
  for (int i = 0; i < list.getSize(); ++i) {
    const openni::DeviceInfo& info = list[i];
    out.push_back({info.getUri(), trimmed(info.getVendor()), trimmed(info.getName()),
                   info.getUsbVendorId(), info.getUsbProductId()});
  }
  return out;
}

int chooseDevice(const std::vector<DeviceName>& devices, const std::string& wanted) {
  if (wanted == "any") return devices.empty() ? -1 : 0;
  int same_kind = -1;
  int of_kind = 0;
  for (int i = 0; i < static_cast<int>(devices.size()); ++i) {
    const std::string& uri = devices[static_cast<std::size_t>(i)].uri;
    if (uri == wanted) return i;
    if (!kindOf(uri).empty() && kindOf(uri) == kindOf(wanted)) {
      same_kind = i;
      ++of_kind;
    }
  }
  return of_kind == 1 ? same_kind : -1;
}

}  // namespace rf
