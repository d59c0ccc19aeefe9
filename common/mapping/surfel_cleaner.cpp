// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "geometry/parallel.hpp"
#include "mapping/surfel_fusion.hpp"

namespace rf {
namespace {

struct FreeSpace {
  Eigen::Matrix3f R;  // camera from body
  Eigen::Vector3f t;
  float penalty, base, sigmas, remove_below;
  SensorModel sensor;
};

// Whether the sensor looks through slot k of the block.
bool seenThrough(const FrameMaps& frame, const FreeSpace& f, const SurfelBlock& b, std::size_t k) {
  const Camera& c = frame.camera;
  const float z = f.R(2, 0) * b.x[k] + f.R(2, 1) * b.y[k] + f.R(2, 2) * b.z[k] + f.t.z();
  if (!(z > 0.05F)) return false;
  const float x = f.R(0, 0) * b.x[k] + f.R(0, 1) * b.y[k] + f.R(0, 2) * b.z[k] + f.t.x();
  const float y = f.R(1, 0) * b.x[k] + f.R(1, 1) * b.y[k] + f.R(1, 2) * b.z[k] + f.t.y();
  const float u = static_cast<float>(c.fx) * x / z + static_cast<float>(c.cx) + 0.5F;
  const float v = static_cast<float>(c.fy) * y / z + static_cast<float>(c.cy) + 0.5F;
  if (!(u >= 1 && v >= 1 && u < static_cast<float>(c.width - 1) &&
        v < static_cast<float>(c.height - 1))) {
    return false;
  }
  const float clear = frame.farthest_clear(static_cast<int>(u), static_cast<int>(v));
  return clear - z > f.base + f.sigmas * f.sensor.sigma(clear);
}

// Lowers the confidence of the surfels that the sensor looks through and marks those that have to
// go; true if there was one.
bool lookThrough(const FrameMaps& frame, const FreeSpace& f, std::int32_t time, SurfelBlock& b) {
  bool any = false;
  for (int i = 0; i < b.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (b.born[k] != time && seenThrough(frame, f, b, k)) b.logit[k] -= f.penalty;
    if (b.logit[k] >= f.remove_below) continue;
    b.radius[k] = 0;
    any = true;
  }
  return any;
}

// Marks surfels of age `age` or more that are still unstable; true if there was one.
bool markUnstable(std::int32_t time, std::int32_t age, float stable, SurfelBlock& b) {
  bool any = false;
  for (int i = 0; i < b.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (b.logit[k] < stable && time - b.born[k] >= age) {
      b.radius[k] = 0;
      any = true;
    }
  }
  return any;
}

}  // namespace

void SurfelCleaner::noteGrowth(const std::vector<int>& blocks, std::int32_t time) {
  if (!blocks.empty()) growth_.push_back({time, blocks});
}

void SurfelCleaner::noteVanished(const SurfelBlock& b, std::int32_t time) {
  for (int i = 0; i < b.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (!(b.radius[k] > 0) && b.seen[k] > b.born[k]) vanished_.add({b.x[k], b.y[k], b.z[k]}, time);
  }
}

std::int64_t SurfelCleaner::clean(const FrameMaps& frame, const SE3& T_FC, std::int32_t time,
                                  const FusionConfig& config, const std::vector<int>& visible,
                                  SurfelMap& map) {
  const SE3 T_CF = T_FC.inverse();
  const SurfelConfig& s = config.surfels;
  const FreeSpace f{T_CF.R().cast<float>(),
                    T_CF.t.cast<float>(),
                    static_cast<float>(s.free_log_odds),
                    static_cast<float>(s.free_base_m),
                    static_cast<float>(s.free_sigma),
                    static_cast<float>(s.remove_log_odds),
                    SensorModel(config.sensor)};
  const auto n = static_cast<int>(visible.size());
  std::vector<int> touched(visible.size(), 0);
  constexpr int kBlocks = 16;  // blocks a chunk
  parallelChunks((n + kBlocks - 1) / kBlocks, [&](int chunk) {
    for (int i = chunk * kBlocks; i < std::min(n, (chunk + 1) * kBlocks); ++i) {
      const auto k = static_cast<std::size_t>(i);
      touched[k] = lookThrough(frame, f, time, map.block(visible[k])) ? 1 : 0;
    }
  });
  const std::int64_t before = map.size();
  const float stable = logit(s.stable_confidence);
  while (!growth_.empty() && time - growth_.front().time >= s.unstable_age) {
    for (const int index : growth_.front().blocks) {
      if (markUnstable(time, s.unstable_age, stable, map.block(index))) map.compact(index);
    }
    growth_.pop_front();
  }
  for (std::size_t k = 0; k < visible.size(); ++k) {
    if (touched[k] == 0) continue;
    noteVanished(map.block(visible[k]), time);
    map.compact(visible[k]);
  }
  return before - map.size();
}

}  // namespace rf
