// SPDX-License-Identifier: BSD-3-Clause
#include "sheet.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "canvas.hpp"

namespace rf::render {
namespace {

constexpr int kColumns = 4;
constexpr int kTileWidth = 336;
constexpr int kCaption = 30;
constexpr std::uint8_t kStatic = 1;
constexpr std::uint8_t kDynamic = 2;

Colour healthColour(const std::string& health) {
  if (health == "tracked") return kGreen;
  if (health == "degraded") return kOrange;
  return kRed;
}

cv::Vec3b blend(const cv::Vec3b& pixel, const cv::Vec3d& colour, double share) {
  cv::Vec3b out;
  for (int i = 0; i < 3; ++i) {
    out[i] = cv::saturate_cast<std::uint8_t>((1 - share) * pixel[i] + share * colour[i]);
  }
  return out;
}

cv::Vec3b greyed(const cv::Vec3b& pixel) {
  const double luma = 0.114 * pixel[0] + 0.587 * pixel[1] + 0.299 * pixel[2];
  const auto value = cv::saturate_cast<std::uint8_t>(0.55 * luma + 50);
  return {value, value, value};
}

/// A small patch of the colour that the overlay gives and its meaning; returns where the next goes.
double legendEntry(Canvas& canvas, double x, double y, const Colour& colour,
                   const std::string& words) {
  canvas.rectangle({x, y - 11, 16, 12}, colour, true);
  canvas.text({x + 22, y}, words, 11, kBlack);
  return x + 22 + Canvas::textWidth(words, 11) + 24;
}

void drawHead(Canvas& canvas, const std::string& title) {
  canvas.text({kGap, 24}, title, 15, kBlack);
  double x = kGap;
  x = legendEntry(canvas, x, 50, {70, 70, 225}, "moving body");
  x = legendEntry(canvas, x, 50, {225, 175, 150}, "static world");
  x = legendEntry(canvas, x, 50, {150, 150, 150}, "no depth measured");
  canvas.text({x, 50}, "%: share of the pixels with depth that move", 11, kGrey);
}

void drawTile(Canvas& canvas, cv::Point at, int height, const SheetFrame& frame) {
  cv::Mat tile;
  cv::resize(overlay(frame.colour, frame.mask), tile, {kTileWidth, height}, 0, 0, cv::INTER_AREA);
  canvas.paste(at, tile);
  const double y = at.y + height + 18;
  canvas.text({double(at.x), y}, fmt::format("frame {}  {:.2f} s", frame.seq, frame.time_s), 11,
              kBlack);
  std::string share = frame.mask.empty() ? "no mask" : "";
  if (frame.dynamic_share) share = fmt::format("{:.0f} %", 100 * *frame.dynamic_share);
  canvas.text({at.x + 0.62 * kTileWidth, y}, share, 11, kBlack, Align::kCentre);
  canvas.text({double(at.x + kTileWidth), y}, frame.health.empty() ? "no result" : frame.health, 11,
              healthColour(frame.health), Align::kRight);
}

}  // namespace

std::vector<std::size_t> spreadOver(std::size_t count, std::size_t wanted) {
  std::vector<std::size_t> chosen;
  wanted = std::min(wanted, count);
  for (std::size_t i = 0; i < wanted; ++i) {
    chosen.push_back(wanted == 1 ? 0 : (i * (count - 1) + (wanted - 1) / 2) / (wanted - 1));
  }
  return chosen;
}

cv::Mat overlay(const cv::Mat& colour, const cv::Mat& mask) {
  cv::Mat out = colour.clone();
  if (mask.size() != colour.size()) return out;
  for (int v = 0; v < out.rows; ++v) {
    auto* row = out.ptr<cv::Vec3b>(v);
    const auto* labels = mask.ptr<std::uint8_t>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (labels[u] == kDynamic) {
        row[u] = blend(row[u], {20, 20, 240}, 0.6);
      } else if (labels[u] == kStatic) {
        row[u] = blend(row[u], {255, 140, 60}, 0.22);
      } else {
        row[u] = greyed(row[u]);
      }
    }
  }
  return out;
}

cv::Mat contactSheet(const std::vector<SheetFrame>& frames, const std::string& title) {
  const cv::Size size = frames.empty() ? cv::Size(640, 480) : frames.front().colour.size();
  const int height = std::max(1, kTileWidth * size.height / std::max(1, size.width));
  const int rows = (static_cast<int>(frames.size()) + kColumns - 1) / kColumns;
  Canvas canvas(kColumns * (kTileWidth + kGap) + kGap, kHead + rows * (height + kCaption) + kGap);
  drawHead(canvas, title);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int column = static_cast<int>(i) % kColumns;
    const int row = static_cast<int>(i) / kColumns;
    const cv::Point at(kGap + column * (kTileWidth + kGap), kHead + row * (height + kCaption));
    drawTile(canvas, at, height, frames[i]);
  }
  return canvas.finish();
}

}  // namespace rf::render
