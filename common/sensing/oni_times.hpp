// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rf {

/// OpenNI2 lets the time stamps of each stream of an .oni file begin at 0 and so forgets how far
/// colour was from depth. rf-capture writes what is lost beside the recording: FILE.oni.yaml.
struct OniTimes {
  double depth_start_us = 0;
  double colour_start_us = 0;

  template <class V>
  void visit(V& v) {
    v("depth_start_us", depth_start_us, 0.0, 9e15, "us",
      "the device's time of the first depth image");
    v("colour_start_us", colour_start_us, 0.0, 9e15, "us",
      "the device's time of the first colour image");
  }
};

inline std::string timesFileOf(const std::string& oni_file) { return oni_file + ".yaml"; }

}  // namespace rf
