// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/body_model.hpp"

#include <algorithm>
#include <cmath>

#include "values/model_state.hpp"

namespace rf {
namespace {

constexpr float kPreferObject = 0.02F;  // metres

float explainGate(const SensorModel& sensor, const SurfelConfig& s, float z) {
  return static_cast<float>(s.match_base_m) + static_cast<float>(s.match_sigma) * sensor.sigma(z);
}

struct Nearest {
  float depth = 0;
  std::uint8_t body = kBodyNone;
};

Nearest nearestAt(const Prediction& world, const Prediction* object, std::size_t i, float stable) {
  Nearest n;
  if (world.depth[i] > 0 && world.logit[i] >= stable) n = {world.depth[i], kBodyStatic};
  if (object == nullptr || !(object->depth[i] > 0) || object->logit[i] < stable) return n;
  if (n.body == kBodyNone || object->depth[i] < n.depth + kPreferObject)
    return {object->depth[i], kBodyObject};
  return n;
}

std::vector<Surfel> surfelsOf(const SurfelMap& map, double least_confidence) {
  const float least = logit(std::max(least_confidence, 1e-6));
  std::vector<Surfel> out;
  for (int i = 0; i < map.blocks(); ++i) {
    const SurfelBlock& b = map.block(i);
    for (int slot = 0; slot < b.count; ++slot) {
      const Surfel s = b.get(slot);
      if (s.logit >= least && s.radius > 0) out.push_back(s);
    }
  }
  return out;
}

std::uint8_t byteOf(float colour) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(colour), 0L, 255L));
}

}  // namespace

BodyModel::BodyModel(const FusionConfig& config, const Camera& camera)
    : map(config.surfels.cell_m, config.surfels.max_surfels),
      prediction(Prediction::nothing(camera)) {}

Image<std::uint8_t> explainedBy(const Prediction& p, const FrameMaps& frame,
                                const FusionConfig& config) {
  const SensorModel sensor(config.sensor);
  const float stable = logit(config.surfels.stable_confidence);
  Image<std::uint8_t> out(p.camera.width, p.camera.height);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const float z = frame.depth[i];
    const bool on = z > 0 && p.depth[i] > 0 && p.logit[i] >= stable &&
                    std::abs(z - p.depth[i]) < explainGate(sensor, config.surfels, z);
    out[i] = on ? 1 : 0;
  }
  return out;
}

Agreement agreement(const Prediction& p, const FrameMaps& frame, const FusionConfig& config) {
  const SensorModel sensor(config.sensor);
  const float stable = logit(config.surfels.stable_confidence);
  Agreement a;
  for (std::size_t i = 0; i < p.depth.size(); ++i) {
    if (!(p.depth[i] > 0) || p.logit[i] < stable) continue;
    const float z = frame.depth[i];
    const float gate = z > 0 ? explainGate(sensor, config.surfels, z) : 0.0F;
    if (z > 0 && std::abs(z - p.depth[i]) < gate) {
      a.on_surface += 1;
    } else if (z > p.depth[i]) {
      a.through += 1;
    } else {
      a.hidden += 1;
    }
  }
  return a;
}

std::int64_t stablePixels(const Prediction& p, float stable_logit) {
  std::int64_t n = 0;
  for (std::size_t i = 0; i < p.depth.size(); ++i)
    n += p.depth[i] > 0 && p.logit[i] >= stable_logit ? 1 : 0;
  return n;
}

FeedbackPlanes feedbackPlanes(const Prediction& world, const Prediction* object,
                              const Camera& input, int model_reduction, int reduction,
                              float stable_logit) {
  const int w = input.width / reduction;
  const int h = input.height / reduction;
  FeedbackPlanes out{Image<std::uint16_t>(w, h), Image<std::uint8_t>(w, h)};
  const Camera& c = world.camera;
  const auto first = [&](int pixel) { return pixel * reduction / model_reduction; };
  const auto last = [&](int pixel) {
    return std::max(first(pixel),
                    ((pixel + 1) * reduction + model_reduction - 1) / model_reduction - 1);
  };
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      Nearest best;
      for (int y = first(v); y <= std::min(last(v), c.height - 1); ++y) {
        for (int x = first(u); x <= std::min(last(u), c.width - 1); ++x) {
          const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(c.width) +
                         static_cast<std::size_t>(x);
          const Nearest n = nearestAt(world, object, i, stable_logit);
          if (n.body != kBodyNone && (best.body == kBodyNone || n.depth < best.depth)) best = n;
        }
      }
      out.depth_mm(u, v) =
          static_cast<std::uint16_t>(std::clamp(std::lround(best.depth * 1000.0F), 0L, 65535L));
      out.body(u, v) = best.body;
    }
  }
  return out;
}

std::vector<SurfelPoint> exportSurfels(const BodyModel& body, const SE3& T,
                                       const SurfelConfig& config) {
  const std::vector<Surfel> surfels = surfelsOf(body.map, config.export_confidence);
  std::vector<std::uint8_t> left_out(surfels.size(), 0);
  if (!config.export_remnants) left_out = body.cleaner.vanished().remnants(surfels);
  const Mat3 R = T.R();
  std::vector<SurfelPoint> out;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    if (left_out[i] != 0) continue;
    const Surfel& s = surfels[i];
    const Eigen::Vector3f p = (R * s.point.cast<double>() + T.t).cast<float>();
    const Eigen::Vector3f n = (R * s.normal.cast<double>()).cast<float>();
    out.push_back({p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), byteOf(s.colour.x()),
                   byteOf(s.colour.y()), byteOf(s.colour.z()), s.radius,
                   1.0F / (1.0F + std::exp(-s.logit))});
  }
  return out;
}

}  // namespace rf
