// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace rf {

inline constexpr auto kCameraGap = std::chrono::seconds(1);   ///< RF_CAMERA is sent this often
inline constexpr auto kPoll = std::chrono::milliseconds(20);  ///< longest wait for a frame

}  // namespace rf
