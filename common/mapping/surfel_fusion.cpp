// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/surfel_fusion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

constexpr float kGrazingFactor = 5.0F;  // largest depth difference of a match, in gates
constexpr float kFinerRadius = 1.5F;    // a measurement coarser than this does not repaint a surfel

struct Rays {
  float ifx, ify, cx, cy;
  explicit Rays(const Camera& c)
      : ifx(static_cast<float>(1.0 / c.fx)),
        ify(static_cast<float>(1.0 / c.fy)),
        cx(static_cast<float>(c.cx)),
        cy(static_cast<float>(c.cy)) {}
  Eigen::Vector3f operator()(int u, int v) const {
    return {(static_cast<float>(u) - cx) * ifx, (static_cast<float>(v) - cy) * ify, 1.0F};
  }
};

Eigen::Vector3f normalAt(const FrameMaps& f, int u, int v) {
  return {f.nx(u, v), f.ny(u, v), f.nz(u, v)};
}

bool mayAppend(const FuseInput& in, int u, int v, const Eigen::Vector3f& normal,
               const Eigen::Vector3f& ray, float cos_min) {
  if (in.weights.interior(u, v) == 0 || normal.z() == 0.0F) return false;
  return -normal.dot(ray) > cos_min * ray.norm();
}

struct PixelUpdate {
  Eigen::Vector3f point, normal, colour;  // body frame
  float weight, radius, log_odds;
};

void applyUpdate(SurfelBlock& b, std::size_t k, const PixelUpdate& m, std::int32_t time,
                 float max_logit, float max_weight) {
  if (b.seen[k] != time || m.log_odds < 0)
    b.logit[k] = std::min(b.logit[k] + m.log_odds, max_logit);
  if (!(m.weight > 0)) return;
  b.seen[k] = time;
  const float blend = m.weight / (b.weight[k] + m.weight);
  const Eigen::Vector3f p(b.x[k], b.y[k], b.z[k]);
  const Eigen::Vector3f n(b.nx[k], b.ny[k], b.nz[k]);
  const Eigen::Vector3f moved = p + n * (n.dot(m.point - p) * blend);
  const Eigen::Vector3f turned = (n + blend * (m.normal - n)).normalized();
  b.x[k] = moved.x();
  b.y[k] = moved.y();
  b.z[k] = moved.z();
  b.nx[k] = turned.x();
  b.ny[k] = turned.y();
  b.nz[k] = turned.z();
  if (m.radius < kFinerRadius * b.radius[k]) {
    b.radius[k] += blend * (m.radius - b.radius[k]);
    b.red[k] += blend * (m.colour.x() - b.red[k]);
    b.green[k] += blend * (m.colour.y() - b.green[k]);
    b.blue[k] += blend * (m.colour.z() - b.blue[k]);
  }
  b.weight[k] = std::min(b.weight[k] + m.weight, max_weight);
  b.cover(static_cast<int>(k));
}

float newRadius(float z, float mean_focal, float nz) {
  const float r = std::sqrt(2.0F) * z / mean_focal;
  return std::min(2.0F * r, r / std::max(std::abs(nz), 1e-3F));
}

Eigen::Vector3f colourOf(Rgb c) {
  return {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)};
}

// Averaging weight of a depth: precision relative to that at one metre.
float precision(const SensorModel& sensor, float z) {
  const float ratio = sensor.sigma(1.0F) / sensor.sigma(z);
  return ratio * ratio;
}

void updateMatched(const FuseInput& in, const FusionConfig& config,
                   const Image<std::uint32_t>& match, SurfelMap& map) {
  const Camera& c = in.frame.camera;
  const Rays rays(c);
  const SensorModel sensor(config.sensor);
  const Eigen::Matrix3f R = in.T_FC.R().cast<float>();
  const Eigen::Vector3f t = in.T_FC.t.cast<float>();
  const auto hit = static_cast<float>(config.surfels.hit_log_odds);
  const auto miss = static_cast<float>(in.miss * config.surfels.miss_log_odds);
  const auto max_logit = static_cast<float>(config.surfels.max_log_odds);
  const auto max_weight = static_cast<float>(config.surfels.max_weight);
  const auto focal = static_cast<float>(0.5 * (c.fx + c.fy));
  // Each chunk owns its blocks and visits the pixels in order: no races, and the same result for
  // every number of chunks.
  const int chunks = threads();
  parallelChunks(chunks, [&](int chunk) {
    for (int v = 0; v < c.height; ++v) {
      for (int u = 0; u < c.width; ++u) {
        const std::uint32_t id = match(u, v);
        if (id >= kMatchAppend) continue;
        const auto index = static_cast<int>(id / kBlockSize);
        if (index % chunks != chunk) continue;
        const float own = in.weights.own(u, v);
        const float z = in.frame.depth(u, v);
        PixelUpdate m{};
        m.weight = own < 0.05F ? 0.0F : own * precision(sensor, z);
        m.log_odds = in.other(u, v) != 0 ? -miss : hit * own;
        if (m.weight > 0) {
          m.point = R * (rays(u, v) * z) + t;
          m.normal = R * normalAt(in.frame, u, v);
          m.colour = colourOf(in.frame.colour(u, v));
          m.radius = newRadius(z, focal, in.frame.nz(u, v));
        }
        applyUpdate(map.block(index), id % kBlockSize, m, in.time, max_logit, max_weight);
      }
    }
  });
}

void appendNew(const FuseInput& in, const FusionConfig& config, const Image<std::uint32_t>& match,
               SurfelMap& map, Prediction& prediction, FuseStats& stats) {
  const Camera& c = in.frame.camera;
  const Rays rays(c);
  const SensorModel sensor(config.sensor);
  const Eigen::Matrix3f R = in.T_FC.R().cast<float>();
  const Eigen::Vector3f t = in.T_FC.t.cast<float>();
  const float start =
      logit(in.first ? config.surfels.birth_confidence : config.surfels.initial_confidence);
  const auto focal = static_cast<float>(0.5 * (c.fx + c.fy));
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      if (match(u, v) != kMatchAppend) continue;
      const float z = in.frame.depth(u, v);
      const Eigen::Vector3f n = normalAt(in.frame, u, v);
      Surfel s;
      s.point = R * (rays(u, v) * z) + t;
      s.normal = R * n;
      s.radius = newRadius(z, focal, n.z());
      s.logit = start;
      s.weight = in.weights.own(u, v) * precision(sensor, z);
      s.colour = colourOf(in.frame.colour(u, v));
      s.born = s.seen = in.time;
      const std::uint32_t id = map.append(s);
      if (id == kNoSurfel) continue;
      stats.grown.push_back(static_cast<int>(id / kBlockSize));
      ++stats.appended;
      prediction.id(u, v) = id;
      prediction.depth(u, v) = z;
      prediction.nx(u, v) = n.x();
      prediction.ny(u, v) = n.y();
      prediction.nz(u, v) = n.z();
      prediction.intensity(u, v) = s.colour.dot(Eigen::Vector3f(0.299F, 0.587F, 0.114F)) / 255.0F;
      prediction.logit(u, v) = start;
    }
  }
  std::sort(stats.grown.begin(), stats.grown.end());
  stats.grown.erase(std::unique(stats.grown.begin(), stats.grown.end()), stats.grown.end());
}

}  // namespace

Image<std::uint32_t> associate(const FuseInput& in, const Prediction& p,
                               const FusionConfig& config) {
  const Camera& c = in.frame.camera;
  const Rays rays(c);
  const SensorModel sensor(config.sensor);
  const auto base = static_cast<float>(config.surfels.match_base_m);
  const auto sigmas = static_cast<float>(config.surfels.match_sigma);
  const auto cos_match = static_cast<float>(config.surfels.match_cos);
  const auto cos_append = static_cast<float>(config.surfels.append_cos);
  Image<std::uint32_t> match(c.width, c.height, kMatchNone);
  parallelRows(c.height, [&](int v) {
    for (int u = 0; u < c.width; ++u) {
      const float z = in.frame.depth(u, v);
      if (!(z > 0)) continue;
      if (!in.forbidden.empty() && in.forbidden(u, v) != 0) continue;
      const Eigen::Vector3f ray = rays(u, v);
      const Eigen::Vector3f n = normalAt(in.frame, u, v);
      const float z_model = p.depth(u, v);
      if (!(z_model > 0)) {
        if (mayAppend(in, u, v, n, ray, cos_append)) match(u, v) = kMatchAppend;
        continue;
      }
      const Eigen::Vector3f n_model(p.nx(u, v), p.ny(u, v), p.nz(u, v));
      const float gate = base + sigmas * sensor.sigma(z);
      const float behind = z - z_model;
      const bool near =
          std::abs(behind) < kGrazingFactor * gate && std::abs(behind * n_model.dot(ray)) < gate;
      if (near) {
        if (n.z() != 0.0F && n.dot(n_model) > cos_match) match(u, v) = p.id(u, v);
      } else if (behind < -gate && mayAppend(in, u, v, n, ray, cos_append)) {
        match(u, v) = kMatchAppend;
      }
    }
  });
  return match;
}

FuseStats fuseFrame(const FuseInput& in, const FusionConfig& config, SurfelMap& map,
                    Prediction& prediction) {
  const Image<std::uint32_t> match = associate(in, prediction, config);
  updateMatched(in, config, match, map);
  FuseStats stats;
  stats.matched =
      std::count_if(match.begin(), match.end(), [](std::uint32_t id) { return id < kMatchAppend; });
  appendNew(in, config, match, map, prediction, stats);
  return stats;
}

}  // namespace rf
