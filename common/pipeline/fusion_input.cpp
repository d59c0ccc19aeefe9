// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/fusion_input.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/pyramid.hpp"

namespace rf {
namespace {

void requireSize(const std::string& what, int w, int h, int want_w, int want_h) {
  if (w == want_w && h == want_h) return;
  throw std::invalid_argument(what + " is " + std::to_string(w) + "x" + std::to_string(h) +
                              ", must be " + std::to_string(want_w) + "x" + std::to_string(want_h));
}

void requireFinite(const std::string& what, const SE3& T) {
  if (!T.isFinite() || std::abs(T.q.norm() - 1.0) > 1e-3) {
    throw std::invalid_argument(what + ": pose must be finite with a unit quaternion");
  }
}

// Nearest-neighbour resampling between working resolutions.
Image<std::uint8_t> resample(const Image<std::uint8_t>& in, int w, int h) {
  if (in.width() == w && in.height() == h) return in;
  Image<std::uint8_t> out(w, h);
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) out(u, v) = in(u * in.width() / w, v * in.height() / h);
  }
  return out;
}

/// No depth where segmentation saw the robot itself: it is neither tracked nor fused.
void leaveSelfOut(const Image<std::uint8_t>& label, Image<float>& depth) {
  if (std::find(label.begin(), label.end(), kSelfLabel) == label.end()) return;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      // Every label whose pixel overlaps this one: the sizes may differ.
      const int u1 = ((u + 1) * label.width() - 1) / depth.width();
      const int v1 = ((v + 1) * label.height() - 1) / depth.height();
      for (int j = v * label.height() / depth.height(); j <= v1; ++j) {
        for (int i = u * label.width() / depth.width(); i <= u1; ++i) {
          if (label(i, j) == kSelfLabel) depth(u, v) = 0;
        }
      }
    }
  }
}

}  // namespace

void checkFusionInput(const RgbdFrame& frame, const SegmentationResult& s, const Camera& camera) {
  if (frame.utime != s.utime) {
    throw std::invalid_argument("segmentation.utime = " + std::to_string(s.utime) +
                                ": must be the frame's, " + std::to_string(frame.utime));
  }
  requireSize("frame.colour", frame.colour.width(), frame.colour.height(), camera.width,
              camera.height);
  requireSize("frame.depth_mm", frame.depth_mm.width(), frame.depth_mm.height(), camera.width,
              camera.height);
  if (s.reduction < 1) {
    throw std::invalid_argument("segmentation.reduction = " + std::to_string(s.reduction) +
                                ": must be >= 1");
  }
  requireSize("segmentation.score", s.score.width(), s.score.height(), camera.width / s.reduction,
              camera.height / s.reduction);
  if (!s.label.empty()) {  // not needed where there is no robot
    requireSize("segmentation.label", s.label.width(), s.label.height(), s.score.width(),
                s.score.height());
  }
  requireFinite("segmentation.camera.T_AB", s.camera.T_AB);
  if (s.object_moving) requireFinite("segmentation.object.T_AB", s.object.T_AB);
  if (s.has_prior_T_WC) requireFinite("segmentation.prior_T_WC", s.prior_T_WC);
  if (s.has_T_CO) requireFinite("segmentation.T_CO", s.T_CO);
}

FusionInput prepareFusionInput(const RgbdFrame& frame, const SegmentationResult& s,
                               const Undistorter& undistorter, const FusionConfig& config) {
  const Image<Rgb> colour = undistorter.colour(frame.colour);
  const Image<std::uint16_t> depth = undistorter.depth(frame.depth_mm);
  RgbdLevel level = reduceFrame(colour, depth, undistorter.camera(), config.reduction,
                                config.sensor.depth_min_m, config.sensor.depth_max_m);
  leaveSelfOut(s.label, level.depth);
  const Camera camera = level.camera;
  FusionInput out;
  out.maps =
      makeFrameMaps(camera, level.depth, reduceColour(colour, config.reduction), config.sensor);
  // The photometric term compares with surfel colours: both sides must come from the same
  // reduction.
  for (std::size_t k = 0; k < level.intensity.size(); ++k) {
    const Rgb c = out.maps.colour[k];
    level.intensity[k] = (0.299F * c.r + 0.587F * c.g + 0.114F * c.b) * (1.0F / 255.0F);
  }
  for (RgbdLevel& l : buildPyramid(std::move(level), config.tracking.levels)) {
    out.pyramid.push_back({l.camera, std::move(l.depth), std::move(l.intensity)});
  }
  out.weights = splitWeights(resample(s.score, camera.width, camera.height), out.maps.depth);
  return out;
}

}  // namespace rf
