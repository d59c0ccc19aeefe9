// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace rf {

/// Maps a device's time stamps to system time. An image arrives a little or much after it was
/// taken, never before: arrival - device = offset + drift * t + delay, delay >= 0 with a least
/// value that keeps coming back. The map is the line under the points (device, arrival - device) of
/// the last minute: the smallest of each second are kept, and of their lower convex hull the edge
/// over the middle of the window is the line (Moon, Skelly, Towsley, "Estimation and removal of
/// clock skew from network delay measurements", INFOCOM 1999: the line below all points with the
/// smallest area between). So late images do not move it and drift is followed. The constant least
/// delay cannot be seen from here; it stays in the result. Pure: both times are arguments. Not
/// thread-safe.
class DeviceClock {
 public:
  /// The system time, microseconds, of a device stamp that arrived at `arrival_us`. Stamps of 32
  /// bit that wrap are unwrapped. A jump of the device's clock or of the system's starts the filter
  /// anew. Results increase strictly.
  std::int64_t observe(std::int64_t device_us, std::int64_t arrival_us);
  /// The same map for another stamp of the same clock, for instance the colour image's; it adds
  /// nothing to the filter. Before the first observe: the stamp itself.
  std::int64_t map(std::int64_t device_us) const;

  /// Rate of system time against device time minus one, or 0 while unknown.
  double drift() const { return slope_; }
  /// How often the filter began anew because a clock jumped.
  int jumps() const { return jumps_; }

 private:
  struct Point {
    double device = 0;  ///< microseconds since the origin, unwrapped
    double offset = 0;  ///< arrival - device, less the first one's, microseconds
  };

  std::int64_t unwrapped(std::int64_t device_us) const;
  double line(double device) const { return base_ + slope_ * device; }
  bool jumped(const Point& point);
  void keep(const Point& point);
  void fit();
  void restart(std::int64_t device_us, std::int64_t arrival_us);

  bool started_ = false;
  std::int64_t wraps_us_ = 0;
  std::int64_t last_raw_ = 0;
  std::int64_t origin_ = 0;        ///< device time of the first point, unwrapped
  std::int64_t first_offset_ = 0;  ///< arrival - device of the first point
  std::deque<Point> lowest_;       ///< the smallest offset of each second, oldest first
  double base_ = 0, slope_ = 0;
  int late_ = 0;  ///< points in a row that were far above the line
  int jumps_ = 0;
  std::optional<std::int64_t> last_result_;
};

}  // namespace rf
