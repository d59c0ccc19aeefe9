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
  //                             right stat, wrong, right dyn, wrong, unknown, no depth, right dyn
  const PixelCounts c = countPixels(row({1, 1, 2, 2, 0, 2, 2}), row({1, 2, 2, 1, 2, 0, 2}));
  EXPECT_EQ(c.static_right, 1);
  EXPECT_EQ(c.static_wrong, 1);
  EXPECT_EQ(c.dynamic_right, 2);
  EXPECT_EQ(c.dynamic_wrong, 1);
  EXPECT_DOUBLE_EQ(c.iou(), 2.0 / 4);
  EXPECT_DOUBLE_EQ(c.staticAccuracy(), 0.5);
  EXPECT_DOUBLE_EQ(c.dynamicAccuracy(), 2.0 / 3);
  EXPECT_THROW(countPixels(row({1}), row({1, 2})), std::invalid_argument);
}

TEST(SegmentationScore, KeepsTheRobotApart) {
  //                       robot found, as object, as static, no depth | object, static taken | rest
  const PixelCounts c = countPixels(row({3, 3, 3, 3, 2, 1, 2, 1}), row({3, 2, 1, 0, 3, 3, 2, 1}));
  EXPECT_EQ(c.self_right, 1);
  EXPECT_EQ(c.self_missed, 2);
  EXPECT_EQ(c.self_wrong, 2);
  EXPECT_EQ(c.dynamic_right, 1);
  EXPECT_EQ(c.dynamic_wrong, 1) << "an object's pixel taken for the robot is lost to the object";
  EXPECT_EQ(c.static_right, 1);
  EXPECT_EQ(c.static_wrong, 0);
  EXPECT_DOUBLE_EQ(c.selfRecall(), 1.0 / 3);
  EXPECT_DOUBLE_EQ(c.selfPrecision(), 1.0 / 3);
  const PixelCounts none = countPixels(row({1, 2}), row({1, 2}));
  EXPECT_DOUBLE_EQ(none.selfRecall(), 1.0);
  EXPECT_DOUBLE_EQ(none.selfPrecision(), 1.0);
  EXPECT_EQ(countMissing(row({3, 3, 2, 1})).self_missed, 2);
  EXPECT_EQ(countMissing(row({3, 3, 2, 1})).dynamic_wrong, 1);
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
