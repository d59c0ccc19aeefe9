// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/fusion_state.hpp"

#include <algorithm>

#include "mapping/prediction.hpp"

namespace rf {
namespace {

constexpr double kMaxBridgeSeconds = 1.0;           // constant velocity is not believed for longer
constexpr double kReferencePixels = 320.0 * 240.0;  // thresholds in pixels are given for this image

}  // namespace

FusionState::FusionState(const FusionConfig& c, const Camera& map_camera)
    : config(c),
      noise(c.sensor.noise),
      camera(map_camera),
      stable(logit(c.surfels.stable_confidence)),
      world(c, map_camera),
      object(c, map_camera) {}

double FusionState::secondsSince(std::int64_t utime) const {
  return std::clamp(static_cast<double>(utime - last_utime) * 1e-6, 0.0, kMaxBridgeSeconds);
}

double FusionState::minInliers() const {
  return config.tracking.min_inliers * static_cast<double>(camera.width * camera.height);
}

double FusionState::minObjectPixels() const {
  return config.tracking.min_object_pixels * static_cast<double>(camera.width * camera.height) /
         kReferencePixels;
}

Health worse(Health a, Health b) {
  const auto known = [](Health h) { return h == Health::kInvalid ? Health::kDegraded : h; };
  return std::max(known(a), known(b));
}

Mat6 stepCovariance(const Mat6& covariance, const TrackingConfig& c) {
  return startCovariance(covariance, c, 0.0);
}

Mat6 startCovariance(const Mat6& cov, const TrackingConfig& c, double extra) {
  Mat6 out = Mat6::Zero();
  const double v = c.start_floor_m * c.start_floor_m * extra;
  const double w = c.start_floor_rad * c.start_floor_rad * extra;
  out.diagonal() << v, v, v, w, w, w;
  constexpr double kBound = 1.0;
  constexpr double kWide = 0.01;  // 10 cm, 0.1 rad
  const bool usable =
      cov.allFinite() && cov.diagonal().minCoeff() >= 0 && cov.cwiseAbs().maxCoeff() < kBound;
  if (usable) return out + c.start_inflation * 0.5 * (cov + cov.transpose());
  return out + Mat6::Identity() * kWide;
}

}  // namespace rf
