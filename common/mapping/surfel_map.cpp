// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/surfel_map.hpp"

#include <algorithm>
#include <cmath>

namespace rf {

Surfel moved(Surfel s, const SE3& T) {
  const Eigen::Matrix3f R = T.R().cast<float>();
  s.point = R * s.point + T.t.cast<float>();
  s.normal = R * s.normal;
  return s;
}

Surfel SurfelBlock::get(int slot) const {
  const auto i = static_cast<std::size_t>(slot);
  Surfel s;
  s.point = {x[i], y[i], z[i]};
  s.normal = {nx[i], ny[i], nz[i]};
  s.radius = radius[i];
  s.logit = logit[i];
  s.weight = weight[i];
  s.colour = {red[i], green[i], blue[i]};
  s.born = born[i];
  s.seen = seen[i];
  return s;
}

void SurfelBlock::set(int slot, const Surfel& s) {
  const auto i = static_cast<std::size_t>(slot);
  x[i] = s.point.x();
  y[i] = s.point.y();
  z[i] = s.point.z();
  nx[i] = s.normal.x();
  ny[i] = s.normal.y();
  nz[i] = s.normal.z();
  radius[i] = s.radius;
  logit[i] = s.logit;
  weight[i] = s.weight;
  red[i] = s.colour.x();
  green[i] = s.colour.y();
  blue[i] = s.colour.z();
  born[i] = s.born;
  seen[i] = s.seen;
}

void SurfelBlock::cover(int slot) {
  const auto i = static_cast<std::size_t>(slot);
  const Eigen::Vector3f p(x[i], y[i], z[i]);
  lower = lower.cwiseMin(p);
  upper = upper.cwiseMax(p);
  max_radius = std::max(max_radius, radius[i]);
}

SurfelMap::SurfelMap(double cell_m, std::int64_t max_surfels)
    : cell_m_(cell_m), max_surfels_(max_surfels) {}

std::uint32_t SurfelMap::append(const Surfel& surfel) {
  constexpr double kMaxCells = 1e5;
  const Eigen::Vector3d c = (surfel.point.cast<double>() / cell_m_).array().floor();
  if (size_ >= max_surfels_ || !(c.cwiseAbs().maxCoeff() < kMaxCells)) return kNoSurfel;
  const Cell cell{static_cast<std::int32_t>(c.x()), static_cast<std::int32_t>(c.y()),
                  static_cast<std::int32_t>(c.z())};
  std::vector<int>& list = cells_[cell];
  const auto has_room = [&](int b) { return block(b).count < kBlockSize; };
  auto it = std::find_if(list.begin(), list.end(), has_room);
  if (it == list.end()) {
    blocks_.push_back(std::make_unique<SurfelBlock>());
    it = list.insert(list.end(), blocks() - 1);
  }
  SurfelBlock& b = block(*it);
  const int slot = b.count++;
  b.set(slot, surfel);
  if (slot == 0) {
    b.lower = b.upper = surfel.point;
    b.max_radius = surfel.radius;
  }
  b.cover(slot);
  ++size_;
  return static_cast<std::uint32_t>(*it) * kBlockSize + static_cast<std::uint32_t>(slot);
}

void SurfelMap::compact(int index) {
  SurfelBlock& b = block(index);
  int kept = 0;
  for (int i = 0; i < b.count; ++i) {
    if (!(b.radius[static_cast<std::size_t>(i)] > 0)) continue;
    if (kept != i) b.set(kept, b.get(i));
    ++kept;
  }
  for (int i = kept; i < b.count; ++i) b.set(i, Surfel{});
  size_ -= b.count - kept;
  b.count = kept;
  b.max_radius = 0;
  if (kept > 0) b.lower = b.upper = b.get(0).point;
  for (int i = 0; i < kept; ++i) b.cover(i);
}

}  // namespace rf
