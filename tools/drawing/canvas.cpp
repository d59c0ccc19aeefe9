// SPDX-License-Identifier: BSD-3-Clause
#include "canvas.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace rf::render {
namespace {

constexpr int kSuper = 2;  ///< drawn pixels per finished pixel
constexpr int kShift = 4;  ///< fractional bits of OpenCV's drawing coordinates
constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;

double fontScale(double size) { return cv::getFontScaleFromHeight(kFont, int(size * kSuper), 1); }

int drawnThickness(double thickness) {
  return std::max(1, static_cast<int>(std::lround(thickness * kSuper)));
}

/// The pieces of a polyline that a dash pattern leaves.
std::vector<std::vector<cv::Point2d>> dashes(const std::vector<cv::Point2d>& points, double on,
                                             double off) {
  std::vector<std::vector<cv::Point2d>> pieces;
  double left = on;
  bool drawing = true;
  if (!points.empty()) pieces.push_back({points.front()});
  for (std::size_t i = 1; i < points.size(); ++i) {
    cv::Point2d a = points[i - 1];
    double length = cv::norm(points[i] - a);
    while (length > left) {
      a += (points[i] - a) * (left / length);
      length -= left;
      if (drawing) pieces.back().push_back(a);
      if (!drawing) pieces.push_back({a});
      drawing = !drawing;
      left = drawing ? on : off;
    }
    left -= length;
    if (drawing) pieces.back().push_back(points[i]);
  }
  return pieces;
}

}  // namespace

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), image_(height * kSuper, width * kSuper, CV_8UC3, kWhite) {}

cv::Point Canvas::scaled(cv::Point2d p) const {
  constexpr double kUnit = kSuper * (1 << kShift);
  return {static_cast<int>(std::lround(p.x * kUnit)), static_cast<int>(std::lround(p.y * kUnit))};
}

double Canvas::textWidth(const std::string& words, double size) {
  int below = 0;
  return static_cast<double>(cv::getTextSize(words, kFont, fontScale(size), 1, &below).width) /
         kSuper;
}

void Canvas::text(cv::Point2d at, const std::string& words, double size, const Colour& colour,
                  Align align) {
  if (align == Align::kCentre) at.x -= textWidth(words, size) / 2;
  if (align == Align::kRight) at.x -= textWidth(words, size);
  cv::putText(image_, words, {int(at.x * kSuper), int(at.y * kSuper)}, kFont, fontScale(size),
              colour, 1, cv::LINE_AA);
}

void Canvas::verticalText(cv::Point2d at, const std::string& words, double size,
                          const Colour& colour) {
  const int length = static_cast<int>(textWidth(words, size)) + 4;
  const int rise = static_cast<int>(size * 2);
  Canvas flat(length, rise);
  flat.text({2, size * 1.4}, words, size, colour);
  cv::Mat turned;
  cv::rotate(flat.image_, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect box(int(at.x * kSuper) - turned.cols / 2, int(at.y * kSuper) - turned.rows / 2,
                     turned.cols, turned.rows);
  if ((box & cv::Rect(0, 0, image_.cols, image_.rows)) == box) turned.copyTo(image_(box));
}

void Canvas::line(cv::Point2d a, cv::Point2d b, const Colour& colour, double thickness) {
  cv::line(image_, scaled(a), scaled(b), colour, drawnThickness(thickness), cv::LINE_AA, kShift);
}

void Canvas::polyline(const std::vector<cv::Point2d>& points, const Colour& colour,
                      double thickness, bool dashed) {
  const auto pieces = dashed ? dashes(points, 7, 5) : std::vector<std::vector<cv::Point2d>>{points};
  for (const auto& piece : pieces) {
    for (std::size_t i = 1; i < piece.size(); ++i) line(piece[i - 1], piece[i], colour, thickness);
  }
}

void Canvas::disc(cv::Point2d centre, double radius, const Colour& colour) {
  const int drawn = static_cast<int>(std::lround(radius * kSuper * (1 << kShift)));
  cv::circle(image_, scaled(centre), drawn, colour, cv::FILLED, cv::LINE_AA, kShift);
}

void Canvas::square(cv::Point2d centre, double half_side, const Colour& colour) {
  rectangle({centre.x - half_side, centre.y - half_side, 2 * half_side, 2 * half_side}, colour,
            true);
}

void Canvas::rectangle(cv::Rect2d box, const Colour& colour, bool filled, double thickness) {
  cv::rectangle(image_, scaled(box.tl()), scaled(box.br()), colour,
                filled ? cv::FILLED : drawnThickness(thickness), cv::LINE_AA, kShift);
}

void Canvas::paste(cv::Point at, const cv::Mat& picture) {
  cv::Mat large;
  cv::resize(picture, large, {}, kSuper, kSuper, cv::INTER_NEAREST);
  const cv::Rect wanted(at.x * kSuper, at.y * kSuper, large.cols, large.rows);
  const cv::Rect box = wanted & cv::Rect(0, 0, image_.cols, image_.rows);
  if (box.empty()) return;
  large(box - wanted.tl()).copyTo(image_(box));
}

cv::Mat Canvas::finish() const {
  cv::Mat reduced;
  cv::resize(image_, reduced, {width_, height_}, 0, 0, cv::INTER_AREA);
  return reduced;
}

}  // namespace rf::render
