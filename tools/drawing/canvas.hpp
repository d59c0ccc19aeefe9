// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace rf::render {

/// Colours in OpenCV's order (blue, green, red).
using Colour = cv::Scalar;
inline const Colour kBlack{30, 30, 30};
inline const Colour kGrey{140, 140, 140};
inline const Colour kLightGrey{225, 225, 225};
inline const Colour kWhite{255, 255, 255};
inline const Colour kBlue{190, 90, 20};
inline const Colour kRed{40, 40, 205};
inline const Colour kOrange{30, 140, 240};
inline const Colour kGreen{60, 140, 40};

inline constexpr int kGap = 14;   ///< between the parts of a picture, and around them
inline constexpr int kHead = 66;  ///< height of its title's lines

enum class Align { kLeft, kCentre, kRight };

/// A white picture that is drawn on at twice its size and reduced at the end, so that lines and the
/// stroke font come out smooth. All coordinates and sizes are pixels of the finished picture.
class Canvas {
 public:
  Canvas(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Text whose base line starts (kLeft), is centred on or ends at `at`; `size`: height of
  /// capitals.
  void text(cv::Point2d at, const std::string& words, double size, const Colour& colour,
            Align align = Align::kLeft);
  /// The same, turned by 90 degrees to the left around `at`.
  void verticalText(cv::Point2d at, const std::string& words, double size, const Colour& colour);
  void line(cv::Point2d a, cv::Point2d b, const Colour& colour, double thickness = 1);
  void polyline(const std::vector<cv::Point2d>& points, const Colour& colour, double thickness,
                bool dashed = false);
  void disc(cv::Point2d centre, double radius, const Colour& colour);
  void square(cv::Point2d centre, double half_side, const Colour& colour);
  void rectangle(cv::Rect2d box, const Colour& colour, bool filled, double thickness = 1);
  /// Copies an 8-bit colour picture, its top-left corner at `at`.
  void paste(cv::Point at, const cv::Mat& picture);
  static double textWidth(const std::string& words, double size);

  /// The finished picture, 8-bit BGR.
  cv::Mat finish() const;

 private:
  cv::Point scaled(cv::Point2d p) const;

  int width_;
  int height_;
  cv::Mat image_;
};

}  // namespace rf::render
