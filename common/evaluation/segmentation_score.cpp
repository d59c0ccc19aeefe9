// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/segmentation_score.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

namespace rf {
namespace {

constexpr std::uint8_t kUnknown = 0;
constexpr std::uint8_t kStatic = 1;
constexpr std::uint8_t kDynamic = 2;
constexpr std::uint8_t kSelf = 3;

double share(std::int64_t part, std::int64_t whole) {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

void countPixel(std::uint8_t truth, std::uint8_t found, PixelCounts& c) {
  if (truth == kUnknown || found == kUnknown) return;
  if (truth == kSelf) {
    (found == kSelf ? c.self_right : c.self_missed) += 1;
    return;
  }
  if (found == kSelf) c.self_wrong += 1;
  if (truth == kStatic) {
    if (found != kSelf) (found == kStatic ? c.static_right : c.static_wrong) += 1;
    return;
  }
  (found == kDynamic ? c.dynamic_right : c.dynamic_wrong) += 1;
}

}  // namespace

PixelCounts& PixelCounts::operator+=(const PixelCounts& o) {
  static_right += o.static_right;
  static_wrong += o.static_wrong;
  dynamic_right += o.dynamic_right;
  dynamic_wrong += o.dynamic_wrong;
  self_right += o.self_right;
  self_missed += o.self_missed;
  self_wrong += o.self_wrong;
  return *this;
}

double PixelCounts::iou() const {
  return share(dynamic_right, dynamic_right + dynamic_wrong + static_wrong);
}
double PixelCounts::staticAccuracy() const {
  return share(static_right, static_right + static_wrong);
}
double PixelCounts::dynamicAccuracy() const {
  return share(dynamic_right, dynamic_right + dynamic_wrong);
}

double PixelCounts::selfRecall() const { return share(self_right, self_right + self_missed); }
double PixelCounts::selfPrecision() const { return share(self_right, self_right + self_wrong); }

PixelCounts countPixels(const Image<std::uint8_t>& truth, const Image<std::uint8_t>& found) {
  if (truth.width() != found.width() || truth.height() != found.height()) {
    throw std::invalid_argument(fmt::format("masks of {}x{} and {}x{} cannot be compared",
                                            truth.width(), truth.height(), found.width(),
                                            found.height()));
  }
  PixelCounts c;
  for (std::size_t i = 0; i < truth.size(); ++i) countPixel(truth[i], found[i], c);
  return c;
}

PixelCounts countMissing(const Image<std::uint8_t>& truth) {
  PixelCounts c;
  c.dynamic_wrong = std::count(truth.begin(), truth.end(), kDynamic);
  c.self_missed = std::count(truth.begin(), truth.end(), kSelf);
  return c;
}

SegmentationScore scoreSegmentation(const std::vector<PixelCounts>& frames, std::size_t missing) {
  SegmentationScore score;
  score.frames = frames.size();
  score.missing = missing;
  PixelCounts sum;
  std::vector<double> ious;
  for (const PixelCounts& frame : frames) {
    sum += frame;
    if (frame.hasDynamic()) ious.push_back(frame.iou());
  }
  if (frames.empty()) return score;
  score.iou = sum.iou();
  score.static_accuracy = sum.staticAccuracy();
  score.dynamic_accuracy = sum.dynamicAccuracy();
  std::sort(ious.begin(), ious.end());
  if (ious.empty()) ious = {1.0};
  score.iou_mean =
      std::accumulate(ious.begin(), ious.end(), 0.0) / static_cast<double>(ious.size());
  score.iou_median = 0.5 * (ious[(ious.size() - 1) / 2] + ious[ious.size() / 2]);
  score.iou_min = ious.front();
  return score;
}

}  // namespace rf
