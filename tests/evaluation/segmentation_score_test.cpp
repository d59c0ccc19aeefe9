// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/segmentation_score.hpp"

#include <initializer_list>

#include <gtest/gtest.h>

namespace rf {
namespace {

Image<std::uint8_t> row(std::initializer_list<std::uint8_t> values) {
  Image<std::uint8_t> image(static_cast<int>(values.size()), 1);
  std::copy(values.begin(), values.end(), image.begin());
  return image;
}

TEST(SegmentationScore, CountsKnownPixelsOnly) {
  //                             right stat, wrong, right dyn, wrong, unknown, no depth, 2nd body
  const PixelCounts c = countPixels(row({1, 1, 2, 2, 0, 2, 3}), row({1, 2, 2, 1, 2, 0, 2}));
  EXPECT_EQ(c.static_right, 1);
  EXPECT_EQ(c.static_wrong, 1);
  EXPECT_EQ(c.dynamic_right, 2);
  EXPECT_EQ(c.dynamic_wrong, 1);
  EXPECT_DOUBLE_EQ(c.iou(), 2.0 / 4);
  EXPECT_DOUBLE_EQ(c.staticAccuracy(), 0.5);
  EXPECT_DOUBLE_EQ(c.dynamicAccuracy(), 2.0 / 3);
  EXPECT_THROW(countPixels(row({1}), row({1, 2})), std::invalid_argument);
}

TEST(SegmentationScore, PoolsPixelsAndRanksFrames) {
  const PixelCounts perfect = countPixels(row({2, 2, 2, 1}), row({2, 2, 2, 1}));
  const PixelCounts half = countPixels(row({2, 2, 1, 1}), row({2, 1, 1, 1}));
  const PixelCounts empty = countPixels(row({1, 1}), row({1, 1}));
  const PixelCounts lost = countMissing(row({2, 1, 0, 2}));
  const SegmentationScore s = scoreSegmentation({perfect, half, empty, lost}, 1);
  EXPECT_EQ(s.frames, 4U);
  EXPECT_EQ(s.missing, 1U);
  EXPECT_DOUBLE_EQ(s.iou, 4.0 / 7);
  EXPECT_DOUBLE_EQ(s.iou_mean, (1 + 0.5 + 0) / 3) << "a frame without the object has no IoU";
  EXPECT_DOUBLE_EQ(s.iou_median, 0.5);
  EXPECT_DOUBLE_EQ(s.iou_min, 0.0);
  EXPECT_DOUBLE_EQ(s.static_accuracy, 1.0);
  EXPECT_DOUBLE_EQ(s.dynamic_accuracy, 4.0 / 7);
  EXPECT_EQ(scoreSegmentation({}, 0).frames, 0U);
}

}  // namespace
}  // namespace rf
