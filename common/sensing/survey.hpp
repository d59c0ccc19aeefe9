// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rf {

/// Text of every OpenNI2 device that is plugged in: URI, maker, serial number, registration, fields
/// of view, and its modes; "! " before formats that rf-capture does not read. Opens each device for
/// a moment; one that cannot be opened is listed with the reason. Empty when there is none. Throws
/// SensingError when OpenNI2 cannot be started.
std::string surveyDevices();

}  // namespace rf
