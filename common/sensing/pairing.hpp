// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "geometry/image.hpp"

namespace rf {

struct DepthImage {
  std::int64_t device_us = 0;   ///< the device's time stamp
  std::int64_t arrival_us = 0;  ///< system time when it came
  Image<std::uint16_t> mm;
};

struct ColourImage {
  std::int64_t device_us = 0;
  Image<Rgb> rgb;
};

/// A depth image and the colour image nearest to it in the device's time, or why there is none.
struct ImagePair {
  DepthImage depth;
  std::optional<ColourImage> colour;
  std::int64_t gap_us = 0;  ///< colour's time minus depth's
  std::string problem;      ///< without colour: the reason
};

/// Pairs the images of two streams that come in any order, late or not at all. A depth image is
/// decided as soon as no nearer colour image can come: when one of its time or later is there, or
/// one before it by less than half the period, or when two later depth images are. A colour image
/// may serve two depth images (it is slower in the dark). Each depth image is given back once, in
/// order. Holds at most a few images. Pure.
class FramePairer {
 public:
  /// `period_us`: between images of a stream; 0 = not known.
  explicit FramePairer(std::int64_t max_gap_us, std::int64_t period_us = 0)
      : max_gap_us_(max_gap_us), period_us_(period_us) {}

  std::vector<ImagePair> add(DepthImage depth);
  std::vector<ImagePair> add(ColourImage colour);
  /// No more images come: decides the rest.
  std::vector<ImagePair> finish();

 private:
  bool decidable() const;
  ImagePair decide();
  std::vector<ImagePair> decideAll(bool end);

  std::int64_t max_gap_us_;
  std::int64_t period_us_;
  std::deque<DepthImage> depths_;
  std::deque<ColourImage> colours_;
};

}  // namespace rf
