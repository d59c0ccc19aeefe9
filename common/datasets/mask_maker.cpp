// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/mask_maker.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "values/segmentation_result.hpp"

namespace rf {
namespace {

constexpr std::uint8_t kHalfScore = 128;

/// Nearest score pixel of an input position: each covers `reduction` input pixels.
int nearest(double position, int reduction, int size) {
  const double at = std::floor((position + 0.5) / reduction);
  return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(size - 1)));
}

}  // namespace

void MaskMaker::prepare(int width, int height, int reduction) {
  if (width == score_width_ && height == score_height_ && reduction == reduction_) return;
  if (reduction < 1 || width < 1 || height < 1 || width != camera_.width / reduction ||
      height != camera_.height / reduction) {
    throw std::invalid_argument(
        fmt::format("scores of {}x{} at reduction {} do not belong to a camera of {}x{}", width,
                    height, reduction, camera_.width, camera_.height));
  }
  score_index_.resize(static_cast<std::size_t>(camera_.width) *
                      static_cast<std::size_t>(camera_.height));
  std::size_t i = 0;
  for (int v = 0; v < camera_.height; ++v) {
    for (int u = 0; u < camera_.width; ++u) {
      const Eigen::Vector2d pixel(u, v);
      const Eigen::Vector2d ideal = camera_.hasDistortion() ? camera_.undistort(pixel) : pixel;
      score_index_[i++] = static_cast<std::uint32_t>(nearest(ideal.y(), reduction, height) * width +
                                                     nearest(ideal.x(), reduction, width));
    }
  }
  score_width_ = width;
  score_height_ = height;
  reduction_ = reduction;
}

Image<std::uint8_t> MaskMaker::make(const Image<std::uint16_t>& depth_mm,
                                    const Image<std::uint8_t>& score,
                                    const Image<std::uint8_t>& label, int reduction) {
  if (depth_mm.width() != camera_.width || depth_mm.height() != camera_.height) {
    throw std::invalid_argument(fmt::format("depth image of {}x{} is not of the camera's {}x{}",
                                            depth_mm.width(), depth_mm.height(), camera_.width,
                                            camera_.height));
  }
  if (!label.empty() && (label.width() != score.width() || label.height() != score.height())) {
    throw std::invalid_argument(fmt::format("labels of {}x{} do not belong to scores of {}x{}",
                                            label.width(), label.height(), score.width(),
                                            score.height()));
  }
  prepare(score.width(), score.height(), reduction);
  Image<std::uint8_t> mask(depth_mm.width(), depth_mm.height(), kMaskNoDepth);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (depth_mm[i] == 0) continue;
    const std::uint32_t at = score_index_[i];
    mask[i] = score[at] < kHalfScore ? kMaskDynamic : kMaskStatic;
    if (!label.empty() && label[at] == kSelfLabel) mask[i] = kMaskSelf;
  }
  return mask;
}

}  // namespace rf
