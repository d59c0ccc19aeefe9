// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include "datasets/tum.hpp"

namespace rf {
namespace {

constexpr std::int64_t kPatternStart = 1000000;
constexpr std::int64_t kPatternPeriod = 33333;
constexpr std::int64_t kColourAfterDepth = 4000;

std::uint8_t byteOf(int value) { return static_cast<std::uint8_t>(value & 255); }

}  // namespace

RgbdFrame patternFrame(int i, int width, int height) {
  RgbdFrame frame;
  frame.utime = kPatternStart + i * kPatternPeriod;
  frame.colour_utime = frame.utime + kColourAfterDepth;
  frame.seq = i;
  frame.colour = Image<Rgb>(width, height);
  frame.depth_mm = Image<std::uint16_t>(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      frame.colour(u, v) = {byteOf(u + 3 * i), byteOf(v + 5 * i), byteOf(u + v)};
      const bool hole = (u + v + i) % 17 == 0;
      frame.depth_mm(u, v) =
          hole ? 0 : static_cast<std::uint16_t>(400 + (u * 7 + v * 11 + i * 13) % 9600);
    }
  }
  return frame;
}

DriverScene::DriverScene(const std::string& folder) {
  if (!folder.empty()) folder_ = std::make_unique<TumDataset>(folder);
}

DriverScene::~DriverScene() = default;

int DriverScene::size() const { return folder_ ? static_cast<int>(folder_->size()) : 0; }

RgbdFrame DriverScene::frame(int i, int width, int height) const {
  if (folder_ && i < size()) {
    auto loaded = folder_->load(static_cast<std::size_t>(i));
    if (loaded.frame && loaded.frame->depth_mm.width() == width &&
        loaded.frame->depth_mm.height() == height) {
      return std::move(*loaded.frame);
    }
  }
  return patternFrame(i, width, height);
}

}  // namespace rf
