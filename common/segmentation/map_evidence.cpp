// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/map_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/parallel.hpp"
#include "values/model_state.hpp"

namespace rf {
namespace {

constexpr double kMostEnergy =
    3.0;                   // log energy of a surface that is four sigma off: no more doubt
constexpr int kReach = 2;  // pixels around a pixel that speak with it
constexpr float kSameSurface = 0.02F;  // ... where their depth differs by no more than this share

struct Seen {
  float z = 0;  // predicted, metres; 0 = nothing
  std::uint8_t body = kBodyNone;
};

/// Depth of the model at a sub-pixel place: bilinear where the four corners show one surface, else
/// the nearest pixel's.
Seen lookUp(const MapView& map, const Vec3& p) {
  if (!(p.z() > 0.05)) return {};
  const Eigen::Vector2d x = map.camera.project(p);
  const int u = static_cast<int>(std::lround(x.x()));
  const int v = static_cast<int>(std::lround(x.y()));
  if (!map.body.inside(u, v) || map.depth_mm(u, v) == 0) return {};
  Seen out{0.001F * static_cast<float>(map.depth_mm(u, v)), map.body(u, v)};
  const int u0 = static_cast<int>(std::floor(x.x()));
  const int v0 = static_cast<int>(std::floor(x.y()));
  if (!map.body.inside(u0, v0) || !map.body.inside(u0 + 1, v0 + 1)) return out;
  float z[4];
  for (int k = 0; k < 4; ++k) {
    const int i = u0 + k % 2;
    const int j = v0 + k / 2;
    if (map.depth_mm(i, j) == 0 || map.body(i, j) != out.body) return out;
    z[k] = 0.001F * static_cast<float>(map.depth_mm(i, j));
  }
  const auto [low, high] = std::minmax_element(z, z + 4);
  if (*high - *low > 0.1F * out.z) return out;
  const auto fu = static_cast<float>(x.x() - u0);
  const auto fv = static_cast<float>(x.y() - v0);
  const float top = z[0] + fu * (z[1] - z[0]);
  const float bottom = z[2] + fu * (z[3] - z[2]);
  out.z = top + fv * (bottom - top);
  return out;
}

/// Distance to a model's surface that agrees with it.
double gateAt(double z, const ImageTermParams& terms, const MapEvidenceParams& params) {
  const double near = std::max(0.0, z - 0.4);
  const double sigma = terms.depth_sigma_base_m + terms.depth_sigma_quadratic * near * near;
  return params.gate_m + params.gate_sigma * sigma;
}

/// How far one model is heard where the images side with the other body.
double doubt(double advantage, const MapEvidenceParams& params) {
  return std::clamp(1.0 - advantage / params.sure_advantage, 0.0, 1.0);
}

}  // namespace

double mapNoise(const MapView& map, const TermLevel& b, const SE3& T_MB_static,
                const ImageTermParams& terms, const MapEvidenceParams& params) {
  constexpr double kNormalMedian = 0.6745;  // of |r| / sigma
  std::vector<double> residuals;
  residuals.reserve(b.depth.size());
  for (int v = 0; v < b.depth.height(); ++v) {
    for (int u = 0; u < b.depth.width(); ++u) {
      const double z = static_cast<double>(b.depth(u, v));
      if (!(z > 0)) continue;
      const Vec3 p = T_MB_static * b.camera.backProject(u, v, z);
      const Seen seen = lookUp(map, p);
      if (seen.body != kBodyStatic) continue;
      const double sigma = gateAt(z, terms, params) / params.gate_sigma;
      residuals.push_back(std::abs(p.z() - static_cast<double>(seen.z)) / sigma);
    }
  }
  if (residuals.empty()) return 1.0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return std::max(1.0, *middle / kNormalMedian);
}

double mapEnergy(const MapView& map, const TermLevel& b, const Image<std::uint8_t>& label,
                 const MapReading& reading, const ImageTermParams& terms,
                 const MapEvidenceParams& params, double outlier_margin) {
  double total = 0;
  double pixels = 0;
  for (int v = 0; v < b.depth.height(); ++v) {
    for (int u = 0; u < b.depth.width(); ++u) {
      const std::uint8_t k = label(u, v);
      if (k >= reading.gamma->size()) continue;
      pixels += 1;
      const double z = static_cast<double>(b.depth(u, v));
      const Vec3 p_b = b.camera.backProject(u, v, z);
      const double sigma = reading.noise * gateAt(z, terms, params) / params.gate_sigma;
      const auto energy = [&](const Vec3& p, std::uint8_t body, double unknown) {
        const Seen seen = lookUp(map, p);
        if (seen.body != body) return unknown;
        const double r = (p.z() - static_cast<double>(seen.z)) / sigma;
        return std::log1p(r * r);
      };
      const double e_s = energy(reading.T_MB_static * p_b, kBodyStatic, -1.0);
      if (e_s < 0) continue;
      const double e_d = energy(reading.T_MB_object * p_b, kBodyObject, outlier_margin);
      const double g = static_cast<double>((*reading.gamma)[k]);
      total += g * std::min(e_s, kMostEnergy) + (1 - g) * std::min(e_d, outlier_margin);
    }
  }
  return pixels > 0 ? total / pixels : 0;
}

Image<MapWitness> mapWitnesses(const MapView& map, const Camera& camera, const Image<float>& depth,
                               const SE3& T_MB_static, const SE3& T_MB_object,
                               const ImageTermParams& terms, const MapEvidenceParams& params) {
  Image<MapWitness> out(depth.width(), depth.height(), MapWitness::kNone);
  parallelRows(out.height(), [&](int v) {
    for (int u = 0; u < out.width(); ++u) {
      const double z = static_cast<double>(depth(u, v));
      if (!(z > 0)) continue;
      const double gate = gateAt(z, terms, params);
      const Vec3 p_b = camera.backProject(u, v, z);
      const Vec3 p_s = T_MB_static * p_b;
      const Vec3 p_d = T_MB_object * p_b;
      const Seen s = lookUp(map, p_s);
      const Seen d = lookUp(map, p_d);
      const double behind = p_s.z() - static_cast<double>(s.z);
      const bool is_static = s.body == kBodyStatic && std::abs(behind) < gate;
      const bool is_object =
          d.body == kBodyObject && std::abs(p_d.z() - static_cast<double>(d.z)) < gate;
      if (is_static != is_object) {
        out(u, v) = is_static ? MapWitness::kStatic : MapWitness::kObject;
      } else if (!is_static && s.body == kBodyStatic && behind < -gate) {
        out(u, v) = MapWitness::kIntruder;
      }
    }
  });
  return out;
}

void addMapEvidence(const Image<MapWitness>& witnesses, const Image<std::uint8_t>& label,
                    const std::vector<double>& advantage, const MapEvidenceParams& params,
                    ScorePrior& scores) {
  const std::size_t count = scores.target.size();
  std::vector<int> pixels(count, 0);
  std::vector<int> world(count, 0);
  std::vector<int> object(count, 0);
  std::vector<int> intruder(count, 0);
  for (std::size_t i = 0; i < label.size(); ++i) {
    const std::uint8_t k = label[i];
    if (k >= count) continue;
    ++pixels[k];
    world[k] += witnesses[i] == MapWitness::kStatic;
    object[k] += witnesses[i] == MapWitness::kObject;
    intruder[k] += witnesses[i] == MapWitness::kIntruder;
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (pixels[k] == 0) continue;
    const double still = doubt(advantage[k], params) * world[k];
    const double moved = doubt(-advantage[k], params) * object[k];
    const double seen = still + moved + params.intruder_share * intruder[k];
    if (!(seen > 0)) continue;
    const double weight = params.weight * seen / pixels[k];
    const double before = static_cast<double>(scores.weight[k]);
    const double target = before * static_cast<double>(scores.target[k]) + weight * still / seen;
    scores.weight[k] = static_cast<float>(before + weight);
    scores.target[k] = static_cast<float>(target / (before + weight));
  }
}

Image<std::uint8_t> refineScores(const Image<MapWitness>& witnesses, const Image<float>& depth,
                                 const Image<std::uint8_t>& label, const std::vector<float>& gamma,
                                 const std::vector<double>& advantage, const Adjacency& adjacency,
                                 const MapEvidenceParams& params) {
  const std::size_t count = gamma.size();
  std::vector<bool> beside(count, false);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t j = 0; j < count && !beside[k]; ++j) {
      beside[k] = gamma[j] < 0.5F && (j == k || adjacency.joined(k, j));
    }
  }
  const auto weight = static_cast<float>(params.pixel_weight);
  std::vector<float> map_weight(count);
  std::vector<float> body_weight(count);
  for (std::size_t k = 0; k < count; ++k) {
    map_weight[k] = weight * static_cast<float>(doubt(advantage[k], params));
    body_weight[k] = weight * static_cast<float>(doubt(-advantage[k], params));
  }
  const auto intruder = static_cast<float>(params.intruder_share);
  // The pixel's own say: its cluster's score and its witness.
  Image<float> own(label.width(), label.height(), 1.0F);
  for (std::size_t i = 0; i < label.size(); ++i) {
    const std::uint8_t k = label[i];
    if (k >= count) continue;
    own[i] = std::clamp(gamma[k], 0.0F, 1.0F);
    if (witnesses[i] == MapWitness::kStatic) own[i] += map_weight[k];
    if (witnesses[i] == MapWitness::kObject) own[i] -= body_weight[k];
    if (witnesses[i] == MapWitness::kIntruder && beside[k]) own[i] -= intruder;
  }
  Image<std::uint8_t> out(label.width(), label.height(), 255);
  parallelRows(out.height(), [&](int v) {
    for (int u = 0; u < out.width(); ++u) {
      if (label(u, v) >= count) continue;
      const float z = depth(u, v);
      float sum = 0;
      int pixels = 0;
      for (int j = std::max(0, v - kReach); j <= std::min(out.height() - 1, v + kReach); ++j) {
        for (int i = std::max(0, u - kReach); i <= std::min(out.width() - 1, u + kReach); ++i) {
          if (label(i, j) >= count || std::abs(depth(i, j) - z) > kSameSurface * z) continue;
          sum += own(i, j);
          ++pixels;
        }
      }
      const float score = std::clamp(sum / static_cast<float>(std::max(1, pixels)), 0.0F, 1.0F);
      out(u, v) = static_cast<std::uint8_t>(std::lround(255.0F * score));
    }
  });
  return out;
}

}  // namespace rf
