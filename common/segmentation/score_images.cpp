// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/score_images.hpp"

#include <algorithm>
#include <cmath>

namespace rf {
namespace {

// 0..1; -1 where the point is out of view.
float lookUp(const Image<std::uint8_t>& scores, const Camera& camera, const Vec3& p) {
  if (!(p.z() > 0.05)) return -1;
  const Eigen::Vector2d x = camera.project(p);
  const int u = static_cast<int>(std::lround(x.x()));
  const int v = static_cast<int>(std::lround(x.y()));
  return scores.inside(u, v) ? static_cast<float>(scores(u, v)) / 255.0F : -1.0F;
}

}  // namespace

ScorePrior warpScores(const Image<std::uint8_t>& previous, const Camera& mask_camera,
                      const TermLevel& level, const Image<std::uint8_t>& label,
                      std::size_t clusters, const SE3& step_s, const SE3& step_d) {
  std::vector<double> sum(clusters, 0.0);
  std::vector<int> count(clusters, 0);
  for (int v = 0; v < label.height(); ++v) {
    for (int u = 0; u < label.width(); ++u) {
      const std::uint8_t k = label(u, v);
      if (k >= clusters) continue;
      const Vec3 p = level.camera.backProject(u, v, static_cast<double>(level.depth(u, v)));
      for (const SE3* step : {&step_s, &step_d}) {
        const float g = lookUp(previous, mask_camera, *step * p);
        if (g < 0) continue;
        sum[k] += static_cast<double>(g);
        ++count[k];
      }
    }
  }
  ScorePrior out{std::vector<float>(clusters, 1.0F), std::vector<float>(clusters, 1.0F)};
  for (std::size_t k = 0; k < clusters; ++k) {
    if (count[k] > 0) out.target[k] = static_cast<float>(sum[k] / count[k]);
  }
  return out;
}

double dynamicShare(const Image<std::uint8_t>& label, const std::vector<float>& gamma) {
  double dynamic = 0;
  double pixels = 0;
  for (const std::uint8_t k : label) {
    if (k >= gamma.size()) continue;
    dynamic += 1.0 - std::clamp(static_cast<double>(gamma[k]), 0.0, 1.0);
    ++pixels;
  }
  return pixels > 0 ? dynamic / pixels : 0;
}

Image<std::uint8_t> scoreImage(const Image<std::uint8_t>& label, const std::vector<float>& gamma) {
  Image<std::uint8_t> out(label.width(), label.height(), 255);
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] < gamma.size()) {
      out[i] =
          static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(gamma[label[i]], 0.0F, 1.0F)));
    }
  }
  return out;
}

}  // namespace rf
