// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <string>
#include <vector>

namespace rf {

/// OpenNI2 loaded for as long as one of these lives; the library is one a process and counts its
/// users itself. Throws SensingError when it cannot be loaded or has no drivers.
class OpenniSession {
 public:
  OpenniSession();
  ~OpenniSession();
  OpenniSession(const OpenniSession&) = delete;
  OpenniSession& operator=(const OpenniSession&) = delete;
};

/// A device as OpenNI2 announces it.
struct DeviceName {
  std::string uri;  ///< how to open it; of a USB device it changes with port and replugging
  std::string vendor;
  std::string name;
  int usb_vendor = 0, usb_product = 0;
};

/// What is plugged in now. Needs a session.
std::vector<DeviceName> connectedDevices();

/// Which of them answers to `wanted` ("any" or a URI): the first for "any"; the same URI; else,
/// after a replug, the only one of the same kind (what stands before the @ of a USB URI). Nothing:
/// -1.
int chooseDevice(const std::vector<DeviceName>& devices, const std::string& wanted);

/// Throws SensingError("what: reason of OpenNI2") unless `status` is good.
void requireOk(openni::Status status, const std::string& what);

}  // namespace rf
