// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rf {

/// Section capture.device: how rf-capture sets an OpenNI2 device up and what it accepts from it.
struct DeviceConfig {
  int width = 640;
  int height = 480;
  int fps = 30;
  bool registration = true;
  bool sync = true;
  bool mirror = false;
  bool auto_exposure = true;
  int exposure = 0;
  bool auto_white_balance = true;
  double max_pair_gap = 0.02;
  double time_offset = 0;
  double stall_timeout = 2;
  double reconnect_period = 1;
  int queue = 2;
  bool record_lossy_colour = false;

  template <class V>
  void visit(V& v) {
    v("width", width, 16, 8192, "px", "of both images; the device must have the mode");
    v("height", height, 16, 8192, "px", "of both images");
    v("fps", fps, 1, 1000, "Hz", "of both images");
    v("registration", registration, "-",
      "the device maps depth into the colour camera; off only when it is registered already");
    v("sync", sync, "-", "the device takes depth and colour at the same time, where it can");
    v("mirror", mirror, "-", "left and right swapped; the pipeline needs it off");
    v("auto_exposure", auto_exposure, "-", "off: brightness steps less, see exposure");
    v("exposure", exposure, 0, 100000, "-",
      "fixed exposure in the driver's unit; 0: keep the device's own");
    v("auto_white_balance", auto_white_balance, "-", "off: white balance stays as it is");
    v("max_pair_gap", max_pair_gap, 0.0, 1.0, "s",
      "a depth image without a colour image this near in time is lost");
    v("time_offset", time_offset, -1.0, 1.0, "s",
      "added to every time stamp; minus the smallest delay from exposure to arrival");
    v("stall_timeout", stall_timeout, 0.1, 60.0, "s",
      "no image for this long: the device is closed and looked for again");
    v("reconnect_period", reconnect_period, 0.05, 60.0, "s",
      "how often a device that is gone is looked for");
    v("queue", queue, 1, 64, "frames",
      "grabbed frames that may wait for the encoder; the oldest is dropped");
    v("record_lossy_colour", record_lossy_colour, "-",
      "--record: colour as JPEG, a tenth of the size; depth is always exact");
  }
};

}  // namespace rf
