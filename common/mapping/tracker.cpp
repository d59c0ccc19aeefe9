// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "geometry/parallel.hpp"
#include "geometry/pyramid.hpp"
#include "mapping/alignment_covariance.hpp"
#include "mapping/sensor_model.hpp"

namespace rf {
namespace {

constexpr std::size_t kChunk = 4096;  // points a chunk; fixed, so that thread counts do not matter

KernelSums sumRows(const ReferencePoints& points, const KernelInput& input) {
  const auto chunks = static_cast<int>((points.size() + kChunk - 1) / kChunk);
  return reduceChunks(chunks, KernelSums{}, [&](int i, KernelSums& s) {
    const std::size_t begin = static_cast<std::size_t>(i) * kChunk;
    accumulateRows(points, begin, std::min(points.size(), begin + kChunk), input, s);
  });
}

constexpr double kLeastResidual = 0.5;    // of sigma: no sensor is more than twice as good
constexpr double kEnoughWeight = 50.0;    // pixels, to compare brightness
constexpr double kEnoughVariance = 1e-3;  // of the model's intensity: 0.03 standard deviation
constexpr double kBlankVariance = 1e-4;   // of an image: three grey levels, little more than noise

// Second moments of the model's (P) and the image's (C) intensity over the pairs.
struct Brightness {
  double mean_p = 0, mean_c = 0, var_p = 0, var_c = 0, cov = 0;
  bool plain = true;  // too few pairs or too little contrast of the model to compare
};

Brightness brightnessOf(const KernelSums& s) {
  Brightness b;
  if (!(s.sw > kEnoughWeight)) return b;
  b.mean_p = s.sp / s.sw;
  b.mean_c = s.sc / s.sw;
  b.var_p = s.spp / s.sw - b.mean_p * b.mean_p;
  b.var_c = s.scc / s.sw - b.mean_c * b.mean_c;
  b.cov = s.spc / s.sw - b.mean_p * b.mean_c;
  b.plain = !(b.var_p > kEnoughVariance);
  return b;
}

// Robust scales and brightness for the next iteration, from this one's residuals.
void adapt(const KernelSums& s, KernelInput& input) {
  static constexpr double kMeanToSigma = 1.2533;  // of the mean absolute value of a normal variable
  static constexpr double kLargest = 20.0;
  const auto scale = [](double sum, double weight) {
    return weight > 0 ? static_cast<float>(std::clamp(kMeanToSigma * sum / weight, 1.0, kLargest))
                      : 1.0F;
  };
  input.scale_depth = scale(s.abs_depth, s.weight_depth);
  input.scale_intensity = scale(s.abs_intensity, s.weight_intensity);
  if (!(s.sw > kEnoughWeight)) return;
  const Brightness b = brightnessOf(s);
  const double gain = std::clamp(b.plain ? 1.0 : b.cov / b.var_p, 0.8, 1.25);
  input.gain = static_cast<float>(gain);
  input.offset = static_cast<float>(std::clamp(b.mean_c - gain * b.mean_p, -0.2, 0.2));
}

void setPose(const SE3& T_PC, KernelInput& input) {
  const SE3 T_CP = T_PC.inverse();
  const Mat3 R = T_CP.R();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      input.R_CP[static_cast<std::size_t>(3 * r + c)] = static_cast<float>(R(r, c));
    input.t_CP[static_cast<std::size_t>(r)] = static_cast<float>(T_CP.t(r));
  }
}

struct Estimate {
  SE3 T_PC;
  Mat6 information = Mat6::Zero();
  KernelSums sums;
  KernelInput input;      // of the last step, with its scales and brightness
  std::size_t level = 0;  // and its level
  int iterations = 0;
};

// Gauss-Newton at one level; the last sums are those at the final pose but one.
void refineLevel(const TrackReference& reference, KernelInput input, const SE3& start,
                 const Mat6& prior, int iterations, const TrackingConfig& c, Estimate& e) {
  input.scale_depth = input.scale_intensity = 3.0F;
  for (int i = 0; i < iterations; ++i) {
    setPose(e.T_PC, input);
    e.sums = sumRows(reference.points, input);
    adapt(e.sums, input);
    e.input = input;
    const Mat6 H = hessianOf(e.sums) / c.correlation;
    const Vec6 b = Eigen::Map<const Vec6>(e.sums.b.data()) / c.correlation;
    const Vec6 from_start = (start.inverse() * e.T_PC).log();
    e.information = H + prior;
    const Vec6 step = e.information.ldlt().solve(b - prior * from_start);
    ++e.iterations;
    if (!step.allFinite() || step.norm() > 0.5) return;
    e.T_PC = e.T_PC * SE3::exp(step);
    if (step.norm() < c.stop_twist) return;
  }
}

Mat6 inverseOf(const Mat6& m) { return m.ldlt().solve(Mat6::Identity()); }

std::string verdict(const TrackResult& r, const SE3& start, const Mat6& start_cov,
                    double min_inliers, double pixels, const TrackingConfig& c) {
  if (!r.T_PC.isFinite()) return "pose not finite";
  if (!(r.inliers >= min_inliers))
    return fmt::format("{:.0f} inliers, need {:.0f}", r.inliers, min_inliers);
  if (!(r.inlier_share >= c.min_inlier_share))
    return fmt::format("inlier share {:.2f}", r.inlier_share);
  if (!(r.visible_share >= c.min_visible_share))
    return fmt::format("visible share {:.2f}", r.visible_share);
  if (!(r.rms_sigma <= c.max_rms_sigma)) return fmt::format("rms {:.2f} sigma", r.rms_sigma);
  const Vec6 d = (start.inverse() * r.T_PC).log();
  if (!(d.head<3>().norm() <= c.max_shift_m))
    return fmt::format("shifted {:.3f} m", d.head<3>().norm());
  if (!(d.tail<3>().norm() <= c.max_turn_rad))
    return fmt::format("turned {:.3f} rad", d.tail<3>().norm());
  const bool sure = r.inliers >= c.sure_inliers * pixels && r.inlier_share >= c.sure_share &&
                    r.rms_sigma <= c.sure_rms_sigma;
  if (sure) return {};
  const double chi = std::sqrt(std::max(0.0, d.dot((start_cov + r.covariance).ldlt().solve(d))));
  if (!(chi <= c.max_chi)) return fmt::format("{:.1f} sigma from the start", chi);
  return {};
}

void compareBrightness(const KernelSums& sums, TrackResult& r) {
  const Brightness b = brightnessOf(sums);
  r.blind = !b.plain && b.var_c < kBlankVariance;
  r.likeness = b.plain || r.blind ? 1.0 : b.cov / std::sqrt(b.var_p * b.var_c);
}

// 2x2 mean of normals that agree with the coarser level's having depth there.
void halveNormals(const Prediction& fine, const RgbdLevel& coarse, Prediction& out) {
  out = Prediction::nothing(coarse.camera);
  out.depth = coarse.depth;
  out.intensity = coarse.intensity;
  for (int v = 0; v < coarse.camera.height; ++v) {
    for (int u = 0; u < coarse.camera.width; ++u) {
      const float z = coarse.depth(u, v);
      if (!(z > 0)) continue;
      Eigen::Vector3f n = Eigen::Vector3f::Zero();
      float trust = -1e9F;
      for (int k = 0; k < 4; ++k) {
        const int x = 2 * u + k % 2;
        const int y = 2 * v + k / 2;
        if (!(fine.depth(x, y) > 0) || std::abs(fine.depth(x, y) - z) > 0.1F) continue;
        n += Eigen::Vector3f(fine.nx(x, y), fine.ny(x, y), fine.nz(x, y));
        trust = std::max(trust, fine.logit(x, y));
      }
      const float norm = n.norm();
      if (!(norm > 0.5F)) {
        out.depth(u, v) = 0;
        continue;
      }
      n /= norm;
      out.nx(u, v) = n.x();
      out.ny(u, v) = n.y();
      out.nz(u, v) = n.z();
      out.logit(u, v) = trust;
    }
  }
}

ReferencePoints collect(const Prediction& p, float full_logit) {
  ReferencePoints r;
  const float full = 1.0F / (1.0F + std::exp(-full_logit));
  const auto points = static_cast<std::size_t>(
      std::count_if(p.depth.begin(), p.depth.end(), [](float z) { return z > 0; }));
  for (std::vector<float>* a : {&r.x, &r.y, &r.z, &r.nx, &r.ny, &r.nz, &r.intensity, &r.weight}) {
    a->resize(points);
  }
  const auto ifx = static_cast<float>(1.0 / p.camera.fx),
             ify = static_cast<float>(1.0 / p.camera.fy);
  const auto cx = static_cast<float>(p.camera.cx), cy = static_cast<float>(p.camera.cy);
  std::size_t k = 0;
  for (int v = 0; v < p.camera.height; ++v) {
    const float ry = (static_cast<float>(v) - cy) * ify;
    for (int u = 0; u < p.camera.width; ++u) {
      const float z = p.depth(u, v);
      if (!(z > 0)) continue;
      const float l = p.logit(u, v);
      r.x[k] = (static_cast<float>(u) - cx) * ifx * z;
      r.y[k] = ry * z;
      r.z[k] = z;
      r.nx[k] = p.nx(u, v);
      r.ny[k] = p.ny(u, v);
      r.nz[k] = p.nz(u, v);
      r.intensity[k] = p.intensity(u, v);
      r.weight[k] = l >= full_logit ? 1.0F : 1.0F / (1.0F + std::exp(-l)) / full;
      ++k;
    }
  }
  return r;
}

}  // namespace

RobustKernel kernelByName(const std::string& name) {
  if (name == "huber") return RobustKernel::kHuber;
  if (name == "tukey") return RobustKernel::kTukey;
  if (name == "cauchy") return RobustKernel::kCauchy;
  throw std::invalid_argument("tracking.kernel = \"" + name + "\": must be huber, tukey or cauchy");
}

WeightPyramid weightPyramid(Image<float> finest, int levels) {
  WeightPyramid pyramid;
  pyramid.push_back(std::move(finest));
  for (int l = 1; l < levels; ++l) {
    const Image<float>& f = pyramid.back();
    Image<float> half(f.width() / 2, f.height() / 2);
    for (int v = 0; v < half.height(); ++v) {
      const float* a = f.row(2 * v);
      const float* b = f.row(2 * v + 1);
      for (int u = 0; u < half.width(); ++u)
        half(u, v) = 0.25F * (a[2 * u] + a[2 * u + 1] + b[2 * u] + b[2 * u + 1]);
    }
    pyramid.push_back(std::move(half));
  }
  return pyramid;
}

std::vector<TrackReference> makeReference(const Prediction& prediction, int levels,
                                          float full_logit) {
  const std::vector<RgbdLevel> pyramid =
      buildPyramid(RgbdLevel{prediction.camera, prediction.intensity, prediction.depth}, levels);
  std::vector<TrackReference> reference;
  reference.push_back({prediction.camera, collect(prediction, full_logit)});
  Prediction fine, coarse;
  for (std::size_t l = 1; l < pyramid.size(); ++l) {
    halveNormals(l == 1 ? prediction : fine, pyramid[l], coarse);
    reference.push_back({coarse.camera, collect(coarse, full_logit)});
    std::swap(fine, coarse);
  }
  return reference;
}

Prediction mergeNearest(const Prediction& a, const Prediction& b) {
  Prediction out = a;
  for (std::size_t i = 0; i < out.depth.size(); ++i) {
    if (!(b.depth[i] > 0) || (a.depth[i] > 0 && a.depth[i] <= b.depth[i])) continue;
    out.id[i] = b.id[i];
    out.depth[i] = b.depth[i];
    out.nx[i] = b.nx[i];
    out.ny[i] = b.ny[i];
    out.nz[i] = b.nz[i];
    out.intensity[i] = b.intensity[i];
    out.logit[i] = b.logit[i];
  }
  return out;
}

KernelInput kernelInput(const TrackLevel& level, const Image<float>& weight, const SE3& T_PC,
                        const FusionConfig& config) {
  const TrackingConfig& t = config.tracking;
  KernelInput in;
  setPose(T_PC, in);
  in.fx = static_cast<float>(level.camera.fx);
  in.fy = static_cast<float>(level.camera.fy);
  in.cx = static_cast<float>(level.camera.cx);
  in.cy = static_cast<float>(level.camera.cy);
  in.width = level.camera.width;
  in.height = level.camera.height;
  in.depth = level.depth.data();
  in.intensity = level.intensity.data();
  in.weight = weight.data();
  const SensorModel sensor(config.sensor);
  in.sigma_base = sensor.base;
  in.sigma_growth = sensor.growth;
  in.sigma_near = sensor.near;
  in.sigma_floor = static_cast<float>(t.sigma_floor_m);
  in.sigma_intensity = static_cast<float>(t.sigma_intensity);
  in.gradient_intensity = static_cast<float>(t.gradient_intensity);
  in.distance = static_cast<float>(t.distance_m);
  in.grazing_cos = static_cast<float>(t.grazing_cos);
  in.use_depth = t.use_depth ? 1.0F : 0.0F;
  in.use_intensity = t.use_intensity ? 1.0F : 0.0F;
  in.kernel = kernelByName(t.kernel);
  return in;
}

TrackResult alignToModel(const std::vector<TrackReference>& reference,
                         const std::vector<TrackLevel>& frame, const WeightPyramid& weights,
                         const SE3& start, const Mat6& start_cov, double min_inliers,
                         const FusionConfig& config) {
  const TrackingConfig& c = config.tracking;
  const Mat6 prior = inverseOf(start_cov);
  Estimate e;
  e.T_PC = start;
  const std::size_t levels = std::min({reference.size(), frame.size(), weights.size()});
  for (std::size_t l = levels; l-- > 0;) {
    KernelInput input = kernelInput(frame[l], weights[l], e.T_PC, config);
    input.distance *= 1.0F + static_cast<float>(c.coarse_distance) * static_cast<float>(l);
    if ((l == 0 ? c.iterations_fine : c.iterations_coarse) > 0) e.level = l;
    refineLevel(reference[l], input, start, prior, l == 0 ? c.iterations_fine : c.iterations_coarse,
                c, e);
  }
  TrackResult r;
  r.T_PC = e.T_PC;
  r.iterations = e.iterations;
  r.covariance = inverseOf(e.information);
  const KernelSums& s = e.sums;
  r.inliers = s.inliers;
  r.pairs = s.pairs;
  r.inlier_share = s.pairs > 0 ? s.inliers / s.pairs : 0;
  r.visible_share = s.in_view > 0 ? s.pairs / s.in_view : 0;
  r.rms_sigma = s.inliers > 0 ? std::sqrt(s.inlier_r2 / s.inliers) : 0;
  r.rms_m = s.inliers > 0 ? std::sqrt(s.inlier_m2 / s.inliers) : 0;
  const double pixels = frame.empty() ? 0.0 : static_cast<double>(frame.front().depth.size());
  r.reason = verdict(r, start, start_cov, min_inliers, pixels, c);
  r.accepted = r.reason.empty();
  compareBrightness(s, r);
  if (!r.accepted) {
    r.T_PC = start;
    r.covariance = start_cov;
  } else if (e.iterations > 0) {
    setPose(e.T_PC, e.input);
    const TrackReference& last = reference[e.level];
    r.covariance =
        alignmentCovariance(alignmentBlocks(last.points, last.camera, e.input),
                            {prior, c.correlation, last.camera.fx, SensorModel(config.sensor),
                             std::max(kLeastResidual, r.rms_sigma), config.sensor.noise});
  }
  return r;
}

}  // namespace rf
