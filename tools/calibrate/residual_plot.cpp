// SPDX-License-Identifier: BSD-3-Clause
#include "residual_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "canvas.hpp"
#include "ticks.hpp"

namespace rf {
namespace {

using namespace render;
using calibration::CalibrationResult;
using calibration::ResidualRow;

constexpr int kWidth = 1100;
constexpr int kHeight = 720;
constexpr double kUsualShare = 0.99;  ///< of the errors that the axis must hold
const Colour kShade{240, 232, 222};
const std::array<Colour, 3> kAxes = {kRed, kGreen, kBlue};
constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};

/// Three components of the error in a unit.
struct Panel {
  cv::Rect2d frame;
  const char* label = "";
  int first = 0;
  double factor = 1;
  double limit = 1;  ///< of the vertical axis, in the unit
  double begin = 0, end = 1;

  cv::Point2d pixel(double time, double value) const {
    const double y = std::clamp(value / limit, -1.0, 1.0);
    return {frame.x + (time - begin) / (end - begin) * frame.width,
            frame.y + 0.5 * frame.height * (1 - y)};
  }
};

double limitOf(const std::vector<ResidualRow>& rows, int first, double factor) {
  std::vector<double> sizes;
  for (const ResidualRow& row : rows) {
    if (!row.used && !row.held_out) continue;
    for (int k = 0; k < 3; ++k) sizes.push_back(std::abs(factor * row.error[first + k]));
  }
  if (sizes.empty()) return 1;
  const auto at = static_cast<std::ptrdiff_t>(kUsualShare * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), sizes.begin() + at, sizes.end());
  return std::max(1e-6, 1.3 * sizes[static_cast<std::size_t>(at)]);
}

void drawAxes(Canvas& canvas, const Panel& p) {
  const double step = tickStep(2 * p.limit, 8);
  for (auto k = std::ceil(-p.limit / step); k * step <= p.limit; ++k) {
    const double y = p.pixel(p.begin, k * step).y;
    canvas.line({p.frame.x, y}, {p.frame.br().x, y}, k == 0 ? kGrey : kLightGrey, 0.5);
    canvas.text({p.frame.x - 6, y + 4}, tickLabel(k * step, step), 10, kBlack, Align::kRight);
  }
  const double step_t = tickStep(p.end - p.begin, 10);
  for (auto k = std::ceil(p.begin / step_t); k * step_t <= p.end; ++k) {
    const double x = p.pixel(k * step_t, 0).x;
    canvas.line({x, p.frame.br().y}, {x, p.frame.br().y + 4}, kGrey, 0.5);
    canvas.text({x, p.frame.br().y + 18}, tickLabel(k * step_t, step_t), 10, kBlack,
                Align::kCentre);
  }
  canvas.rectangle(p.frame, kGrey, false);
  canvas.verticalText({22, p.frame.y + p.frame.height / 2}, p.label, 13, kBlack);
}

void drawPanel(Canvas& canvas, const Panel& p, const std::vector<ResidualRow>& rows) {
  const double half_row = 0.5 * p.frame.width / static_cast<double>(rows.size()) + 1;
  for (const ResidualRow& row : rows) {
    if (!row.held_out) continue;
    const double x = p.pixel(row.time, 0).x;
    canvas.rectangle({x - half_row, p.frame.y, 2 * half_row, p.frame.height}, kShade, true);
  }
  drawAxes(canvas, p);
  for (const ResidualRow& row : rows) {
    for (int k = 0; k < 3; ++k) {
      const bool counts = row.used || row.held_out;
      canvas.disc(p.pixel(row.time, p.factor * row.error[p.first + k]), counts ? 2 : 3,
                  counts ? kAxes[static_cast<std::size_t>(k)] : kGrey);
    }
  }
}

void drawLegend(Canvas& canvas) {
  double x = 80;
  for (std::size_t k = 0; k < kAxes.size(); ++k, x += 60) {
    canvas.disc({x, 52}, 4, kAxes[k]);
    canvas.text({x + 10, 57}, kAxisNames[k], 12, kBlack);
  }
  canvas.disc({x, 52}, 4, kGrey);
  canvas.text({x + 10, 57}, "left out", 12, kBlack);
  canvas.rectangle({x + 90, 45, 14, 14}, kShade, true);
  canvas.text({x + 110, 57}, "held out of the fit", 12, kBlack);
  canvas.text({x + 290, 57}, "(on the frame: beyond it)", 12, kBlack);
}

}  // namespace

cv::Mat residualPlot(const CalibrationResult& result) {
  Canvas canvas(kWidth, kHeight);
  const std::vector<ResidualRow>& rows = result.residuals;
  canvas.text({80, 30},
              fmt::format("What the calibration leaves of each {}, in the axes of the {}",
                          result.baseline > 0 ? "motion" : "pose", nameOfX(result.problem)),
              16, kBlack);
  drawLegend(canvas);
  if (rows.size() < 2) return canvas.finish();
  Panel position{{80, 80, kWidth - 110, 260}, "position [mm]", 0, 1e3, 1, 0, 1};
  Panel rotation{
      {80, 390, kWidth - 110, 260}, "rotation [deg]", 3, 180 / std::numbers::pi, 1, 0, 1};
  for (Panel* p : {&position, &rotation}) {
    p->limit = limitOf(rows, p->first, p->factor);
    p->begin = rows.front().time;
    p->end = rows.back().time;
    drawPanel(canvas, *p, rows);
  }
  canvas.text({80 + rotation.frame.width / 2, kHeight - 16}, "time [s]", 13, kBlack,
              Align::kCentre);
  return canvas.finish();
}

}  // namespace rf
