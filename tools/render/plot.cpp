// SPDX-License-Identifier: BSD-3-Clause
#include "plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "ticks.hpp"

namespace rf::render {
namespace {

constexpr int kWidth = 1200;
constexpr int kHeight = 860;
const cv::Rect2d kFrame(80, 64, 820, 720);  ///< the plot's inside

const cv::Rect2d kInset(960, 520, 220, 220);  ///< the enlarged camera path

struct Bounds {
  cv::Point2d low{1e30, 1e30};
  cv::Point2d high{-1e30, -1e30};
  bool empty() const { return low.x > high.x; }
  double extent() const { return empty() ? 0 : std::max(high.x - low.x, high.y - low.y); }
};

/// Metres to pixels of a panel, the same scale on both axes.
struct Panel {
  cv::Rect2d frame;
  double pixels_per_metre = 1;
  cv::Point2d centre_m;
  cv::Point2d pixel(cv::Point2d m) const {
    const cv::Point2d middle = (frame.tl() + frame.br()) / 2;
    return {middle.x + (m.x - centre_m.x) * pixels_per_metre,
            middle.y - (m.y - centre_m.y) * pixels_per_metre};
  }
};

cv::Point2d onPlane(const Vec3& p, const GroundPlane& plane) {
  return {p.dot(plane.right), p.dot(plane.up)};
}

Bounds boundsOf(const std::vector<Series>& series, const GroundPlane& plane) {
  Bounds bounds;
  for (const Series& line : series) {
    for (const Vec3& p : line.points) {
      const cv::Point2d m = onPlane(p, plane);
      bounds.low = {std::min(bounds.low.x, m.x), std::min(bounds.low.y, m.y)};
      bounds.high = {std::max(bounds.high.x, m.x), std::max(bounds.high.y, m.y)};
    }
  }
  return bounds;
}

Panel fitPanel(const cv::Rect2d& frame, const Bounds& bounds) {
  if (bounds.empty()) return {frame, frame.width, {0, 0}};
  const cv::Point2d extent = bounds.high - bounds.low;
  const double metres_x = std::max(0.05, extent.x * 1.15);
  const double metres_y = std::max(0.05, extent.y * 1.15);
  return {frame, std::min(frame.width / metres_x, frame.height / metres_y),
          (bounds.low + bounds.high) / 2};
}

void drawGrid(Canvas& canvas, const Panel& panel, int ticks) {
  const cv::Rect2d& box = panel.frame;
  const cv::Point2d half(box.width / 2 / panel.pixels_per_metre,
                         box.height / 2 / panel.pixels_per_metre);
  const double step = tickStep(2 * std::max(half.x, half.y), ticks);
  const cv::Point2d low = panel.centre_m - half;
  const cv::Point2d high = panel.centre_m + half;
  for (auto k = std::ceil(low.x / step); k * step <= high.x; ++k) {
    const double x = panel.pixel({k * step, 0}).x;
    canvas.line({x, box.y}, {x, box.br().y}, kLightGrey, 0.5);
    canvas.text({x, box.br().y + 18}, tickLabel(k * step, step), 10, kBlack, Align::kCentre);
  }
  for (auto k = std::ceil(low.y / step); k * step <= high.y; ++k) {
    const double y = panel.pixel({0, k * step}).y;
    canvas.line({box.x, y}, {box.br().x, y}, kLightGrey, 0.5);
    canvas.text({box.x - 6, y + 4}, tickLabel(k * step, step), 10, kBlack, Align::kRight);
  }
  canvas.rectangle(box, kGrey, false);
}

void drawLine(Canvas& canvas, const Panel& panel, const GroundPlane& plane, const Series& line) {
  if (line.points.empty()) return;
  std::vector<cv::Point2d> pixels;
  pixels.reserve(line.points.size());
  for (const Vec3& p : line.points) pixels.push_back(panel.pixel(onPlane(p, plane)));
  canvas.polyline(pixels, line.colour, line.thickness, line.dashed);
  canvas.disc(pixels.front(), 6, line.colour);
  canvas.square(pixels.back(), 5, line.colour);
}

/// Dashed lines last: where lines coincide, what is beneath shows through the gaps.
void drawSeries(Canvas& canvas, const Panel& panel, const GroundPlane& plane,
                const std::vector<Series>& series) {
  for (const bool dashed : {false, true}) {
    for (const Series& line : series) {
      if (line.dashed == dashed) drawLine(canvas, panel, plane, line);
    }
  }
}

double pathLength(const std::vector<Vec3>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

void drawLegend(Canvas& canvas, const std::vector<Series>& series) {
  const double x = kFrame.br().x + 24;
  double y = kFrame.y + 16;
  for (const Series& line : series) {
    if (line.points.empty()) continue;
    canvas.polyline({{x, y - 5}, {x + 38, y - 5}}, line.colour, line.thickness, line.dashed);
    canvas.text({x + 48, y}, line.name, 12, kBlack);
    canvas.text({x + 48, y + 18}, fmt::format("{:.2f} m long", pathLength(line.points)), 10, kGrey);
    y += 46;
  }
  canvas.disc({x + 19, y - 5}, 6, kGrey);
  canvas.text({x + 48, y}, "start", 12, kBlack);
  canvas.square({x + 19, y + 21}, 5, kGrey);
  canvas.text({x + 48, y + 26}, "end", 12, kBlack);
}

/// The camera's lines once more, enlarged, where they are small beside the object's.
void drawInset(Canvas& canvas, const std::vector<Series>& series, const GroundPlane& plane) {
  const std::vector<Series> camera(
      series.begin(), series.begin() + std::min<std::ptrdiff_t>(3, std::ssize(series)));
  const Bounds bounds = boundsOf(camera, plane);
  if (bounds.empty() || bounds.extent() > 0.3 * boundsOf(series, plane).extent()) return;
  const Panel panel = fitPanel(kInset, bounds);
  canvas.text({kInset.x, kInset.y - 10}, "the camera, enlarged", 11, kBlack);
  drawGrid(canvas, panel, 5);
  drawSeries(canvas, panel, plane, camera);
}

}  // namespace

Vec3 skyAxis(const Trajectory& camera) {
  constexpr double kContradicts = 0.3;  ///< cosine below which z cannot be the vertical
  if (camera.empty()) return Vec3::UnitZ();
  const SE3& first = camera.front().pose;
  if (first.t.norm() < 1e-9 && first.q.vec().norm() < 1e-9) return -Vec3::UnitY();
  Vec3 up = Vec3::Zero();
  for (const StampedPose& p : camera) up -= p.pose.q * Vec3::UnitY();
  up /= static_cast<double>(camera.size());
  int axis = 2;
  if (std::abs(up.z()) < kContradicts) up.cwiseAbs().maxCoeff(&axis);
  return up[axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
}

GroundPlane groundPlane(const Vec3& sky) {
  static constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  int axis = 0;
  sky.cwiseAbs().maxCoeff(&axis);
  // The two other axes in cyclic order have their cross product along `axis`.
  const int first = (axis + 1) % 3;
  const int second = (axis + 2) % 3;
  const int right = sky[axis] > 0 ? first : second;
  const int up = sky[axis] > 0 ? second : first;
  return {Vec3::Unit(right), Vec3::Unit(up), kNames[static_cast<std::size_t>(right)],
          kNames[static_cast<std::size_t>(up)]};
}

cv::Mat trajectoryPlot(const std::vector<Series>& series, const GroundPlane& plane,
                       const std::string& title, const std::string& note) {
  Canvas canvas(kWidth, kHeight);
  canvas.text({kFrame.x, 34}, title, 16, kBlack);
  canvas.text({kFrame.x, 54}, note, 11, kGrey);
  const Panel panel = fitPanel(kFrame, boundsOf(series, plane));
  drawGrid(canvas, panel, 8);
  canvas.text({kFrame.x + kFrame.width / 2, kFrame.br().y + 44}, plane.right_name + " [m]", 13,
              kBlack, Align::kCentre);
  canvas.verticalText({22, kFrame.y + kFrame.height / 2}, plane.up_name + " [m]", 13, kBlack);
  drawSeries(canvas, panel, plane, series);
  drawLegend(canvas, series);
  drawInset(canvas, series, plane);
  return canvas.finish();
}

}  // namespace rf::render
