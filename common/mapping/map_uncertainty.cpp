// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_uncertainty.hpp"

#include <algorithm>
#include <cstddef>

#include <Eigen/Cholesky>

namespace rf {
namespace {

constexpr std::int32_t kEpochFrames = 8;  // a quarter of a second: poses change little in it
constexpr double kMaxFrames = 100.0;      // the mean forgets like the surfels' (max_weight)
constexpr std::int32_t kAway = 60;        // frames: longer than a body passes before a surface
constexpr double kInView = 0.005;         // of what is seen: less is a rim that flickers

}  // namespace

std::size_t MapUncertainty::epochOf(std::int32_t time) {
  return static_cast<std::size_t>(std::max(time, 0) / kEpochFrames);
}

Mat6 toLeft(const SE3& T_FC, const Mat6& right) {
  const Mat6 ad = T_FC.adjoint();
  return ad * right * ad.transpose();
}

Mat6 toRight(const SE3& T_FC, const Mat6& left) { return toLeft(T_FC.inverse(), left); }

std::vector<MapUncertainty::Share> MapUncertainty::seen(const SurfelMap& map,
                                                        const Prediction& prediction,
                                                        const Image<float>& weight) const {
  std::vector<double> sums(epochs_.size(), 0.0);
  double total = 0;
  for (std::size_t i = 0; i < prediction.id.size() && !sums.empty(); ++i) {
    const std::uint32_t id = prediction.id[i];
    if (id == kNoSurfel || !(weight[i] > 0)) continue;
    const SurfelBlock& block = map.block(static_cast<int>(id / kBlockSize));
    const auto w = static_cast<double>(weight[i]);
    sums[std::min(epochOf(block.born[id % kBlockSize]), sums.size() - 1)] += w;
    total += w;
  }
  std::vector<Share> shares;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (sums[k] > 0) shares.push_back({k, sums[k] / total});
  }
  return shares;
}

Mat6 MapUncertainty::of(const std::vector<Share>& seen) const {
  if (seen.empty()) return epochs_.empty() ? Mat6(Mat6::Zero()) : epochs_.back().covariance_F;
  Mat6 sum = Mat6::Zero();
  for (const Share& s : seen) sum += s.share * epochs_[s.epoch].covariance_F;
  return sum;
}

void MapUncertainty::fuse(std::int32_t time, const std::vector<Share>& seen,
                          const Mat6& covariance_F) {
  for (const Share& s : seen) {
    Epoch& e = epochs_[s.epoch];
    e.frames = std::min(e.frames + 1, kMaxFrames);
    e.covariance_F += (covariance_F - e.covariance_F) / e.frames;
    if (s.share < kInView) continue;
    e.came_back = e.came_back || time - e.last_view > kAway;
    e.last_view = time;
  }
  if (epochs_.size() <= epochOf(time)) {
    epochs_.resize(epochOf(time) + 1, {covariance_F, 1.0, time, false});
  }
}

bool MapUncertainty::cameBack(std::size_t epoch) const {
  return epoch < epochs_.size() && epochs_[epoch].came_back;
}

std::vector<Mat6> MapUncertainty::takeCorrection(const Mat6& innovation_F, double share) {
  const Mat6 inverse = innovation_F.ldlt().solve(Mat6::Identity());
  std::vector<Mat6> gains;
  for (Epoch& e : epochs_) {
    gains.push_back(e.came_back ? Mat6(Mat6::Zero()) : Mat6(e.covariance_F * inverse));
    e.covariance_F -= share * gains.back() * e.covariance_F;
    e.covariance_F = (0.5 * (e.covariance_F + e.covariance_F.transpose())).eval();
  }
  return gains;
}

}  // namespace rf
