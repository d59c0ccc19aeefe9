// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/device_clock.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rf {
namespace {

constexpr std::int64_t kWrap = std::int64_t{1} << 32;
constexpr double kBucketUs = 1e6;
constexpr double kWindowUs = 60e6;
/// A slope needs points at least this far apart: over 10 s, jitter of the least delay of 1 ms is
/// 100 ppm, what a crystal may be off.
constexpr double kSlopeSpanUs = 10e6;
/// No crystal is worse.
constexpr double kMaxSlope = 1e-3;
/// This far below the line, an image would come before it was taken: the clock jumped.
constexpr double kEarlyUs = 250e3;
/// This far above it for this many images in a row: a jump too, no stall.
constexpr double kLateUs = 500e3;
constexpr int kLateImages = 60;

}  // namespace

std::int64_t DeviceClock::unwrapped(std::int64_t device_us) const {
  if (!started_) return device_us;
  const bool both_short = device_us >= 0 && device_us < kWrap && last_raw_ < kWrap;
  const std::int64_t step = device_us - last_raw_;
  if (both_short && step < -kWrap / 2) return device_us + wraps_us_ + kWrap;
  // A stamp from before a wrap that has been seen: the other image of the pair.
  if (both_short && step > kWrap / 2 && wraps_us_ > 0) return device_us + wraps_us_ - kWrap;
  return device_us + wraps_us_;
}

std::int64_t DeviceClock::map(std::int64_t device_us) const {
  if (!started_) return device_us;
  const std::int64_t whole = unwrapped(device_us);
  return whole + first_offset_ + std::llround(line(static_cast<double>(whole - origin_)));
}

std::int64_t DeviceClock::observe(std::int64_t device_us, std::int64_t arrival_us) {
  if (!started_) {
    restart(device_us, arrival_us);
  } else {
    const std::int64_t whole = unwrapped(device_us);
    const Point point{static_cast<double>(whole - origin_),
                      static_cast<double>(arrival_us - whole - first_offset_)};
    if (jumped(point)) {
      ++jumps_;
      restart(device_us, arrival_us);
    } else {
      wraps_us_ = whole - device_us;
      last_raw_ = device_us;
      keep(point);
      fit();
    }
  }
  std::int64_t result = map(device_us);
  if (last_result_) result = std::max(result, *last_result_ + 1);
  last_result_ = result;
  return result;
}

bool DeviceClock::jumped(const Point& point) {
  const double above = point.offset - line(point.device);
  if (above < -kEarlyUs || point.device < lowest_.back().device - kWindowUs) return true;
  late_ = above > kLateUs ? late_ + 1 : 0;
  return late_ >= kLateImages;
}

void DeviceClock::restart(std::int64_t device_us, std::int64_t arrival_us) {
  started_ = true;
  wraps_us_ = 0;
  last_raw_ = device_us;
  origin_ = device_us;
  first_offset_ = arrival_us - device_us;
  lowest_.assign(1, Point{});
  base_ = slope_ = 0;
  late_ = 0;
}

void DeviceClock::keep(const Point& point) {
  const auto bucket = [](const Point& p) { return std::floor(p.device / kBucketUs); };
  if (bucket(point) > bucket(lowest_.back())) {
    lowest_.push_back(point);
  } else if (point.offset < lowest_.back().offset) {
    lowest_.back() = point;
  }
  while (lowest_.back().device - lowest_.front().device > kWindowUs) lowest_.pop_front();
}

void DeviceClock::fit() {
  std::vector<Point> hull;
  for (const Point& p : lowest_) {
    const auto above = [&](const Point& a, const Point& b) {  // is b on or above the line a to p?
      return (b.offset - a.offset) * (p.device - a.device) >=
             (p.offset - a.offset) * (b.device - a.device);
    };
    while (hull.size() >= 2 && above(hull[hull.size() - 2], hull.back())) hull.pop_back();
    hull.push_back(p);
  }
  const Point& first = lowest_.front();
  const Point& last = lowest_.back();
  const auto least = std::min_element(
      hull.begin(), hull.end(), [](const auto& a, const auto& b) { return a.offset < b.offset; });
  slope_ = 0;
  base_ = least->offset;
  if (last.device - first.device < kSlopeSpanUs) return;
  const double middle = (first.device + last.device) / 2;
  const auto right = std::find_if(hull.begin() + 1, hull.end() - 1,
                                  [&](const Point& p) { return p.device >= middle; });
  const Point& b = *right;
  const Point& a = *(right - 1);
  slope_ = std::clamp((b.offset - a.offset) / (b.device - a.device), -kMaxSlope, kMaxSlope);
  base_ = a.offset - slope_ * a.device;
}

}  // namespace rf
