// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/pairing.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

namespace rf {
namespace {

constexpr std::size_t kPatience = 3;      ///< depth images that may wait, the decided one included
constexpr std::size_t kMaxColours = 4;    ///< colour images that are kept
constexpr std::int64_t kJitterUs = 2000;  ///< by which an image may come before its period is over

}  // namespace

std::vector<ImagePair> FramePairer::add(DepthImage depth) {
  std::vector<ImagePair> out;
  if (!depths_.empty() && depth.device_us <= depths_.back().device_us) {
    // The device's clock jumped back: what waits belongs to the time before.
    out = decideAll(true);
    colours_.clear();
  }
  depths_.push_back(std::move(depth));
  for (ImagePair& pair : decideAll(false)) out.push_back(std::move(pair));
  return out;
}

std::vector<ImagePair> FramePairer::add(ColourImage colour) {
  if (!colours_.empty() && colour.device_us <= colours_.back().device_us) colours_.clear();
  colours_.push_back(std::move(colour));
  std::vector<ImagePair> out = decideAll(false);
  while (colours_.size() > kMaxColours) colours_.pop_front();
  return out;
}

std::vector<ImagePair> FramePairer::finish() {
  std::vector<ImagePair> out = decideAll(true);
  colours_.clear();
  return out;
}

bool FramePairer::decidable() const {
  if (depths_.empty()) return false;
  if (depths_.size() >= kPatience) return true;
  if (colours_.empty()) return false;
  const std::int64_t before = depths_.front().device_us - colours_.back().device_us;
  return before <= 0 || 2 * before < period_us_ - kJitterUs;
}

std::vector<ImagePair> FramePairer::decideAll(bool end) {
  std::vector<ImagePair> out;
  while (decidable() || (end && !depths_.empty())) out.push_back(decide());
  return out;
}

ImagePair FramePairer::decide() {
  ImagePair pair;
  pair.depth = std::move(depths_.front());
  depths_.pop_front();
  const std::int64_t t = pair.depth.device_us;
  const auto nearest =
      std::min_element(colours_.begin(), colours_.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.device_us - t) < std::abs(b.device_us - t);
      });
  if (nearest == colours_.end()) {
    pair.problem = "no colour image came with this depth image";
    return pair;
  }
  pair.gap_us = nearest->device_us - t;
  if (std::abs(pair.gap_us) > max_gap_us_) {
    pair.problem = fmt::format(
        "the nearest colour image is {:.1f} ms away in time: at most {:.1f} ms "
        "(capture.device.max_pair_gap)",
        static_cast<double>(pair.gap_us) / 1000, static_cast<double>(max_gap_us_) / 1000);
    return pair;
  }
  // Later depth images can use this one or a newer one, no older.
  colours_.erase(colours_.begin(), nearest);
  pair.colour = colours_.front();
  return pair;
}

}  // namespace rf
