// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace rf::render {

/// One tile of the contact sheet.
struct SheetFrame {
  cv::Mat colour;  ///< 8-bit BGR
  cv::Mat mask;    ///< 8-bit, 0 no depth, 1 static, 2 dynamic; empty: none in the result
  std::int64_t seq = 0;
  double time_s = 0;                    ///< since the first frame
  std::string health;                   ///< as in frames.csv; empty when the frame is not in it
  std::optional<double> dynamic_share;  ///< 0..1
};

/// Indices of `wanted` frames spread evenly over `count`, first and last included.
std::vector<std::size_t> spreadOver(std::size_t count, std::size_t wanted);

/// The colour picture with dynamic pixels red, static ones faintly blue and those without depth
/// grey.
cv::Mat overlay(const cv::Mat& colour, const cv::Mat& mask);

/// Up to twelve frames with their segmentation, four in a row. Every picture should be of one size.
cv::Mat contactSheet(const std::vector<SheetFrame>& frames, const std::string& title);

}  // namespace rf::render
