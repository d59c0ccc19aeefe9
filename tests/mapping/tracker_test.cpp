// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/tracker.hpp"

#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "geometry/pyramid.hpp"
#include "mapping/body_model.hpp"

namespace rf {
namespace {

double uniform(std::mt19937_64& g, double low, double high) {
  return low + (high - low) * static_cast<double>(g() >> 11U) * 0x1.0p-53;
}

Vec6 twist(double x, double y, double z, double a, double b, double c) {
  Vec6 t;
  t << x, y, z, a, b, c;
  return t;
}

// One frame of the room as model and as pyramid, half of a 320x240 input.
struct View {
  FrameMaps maps;
  std::vector<TrackLevel> pyramid;
  SplitWeights weights;
};

View look(const SE3& T_WC, const FusionConfig& config) {
  const Camera full = test::testCamera();
  const test::Shot shot = test::shoot(test::room(), T_WC, full, {}, 0);
  RgbdLevel level = reduceFrame(shot.frame.colour, shot.frame.depth_mm, full, 2, 0.3, 6.0);
  View v;
  v.maps =
      makeFrameMaps(level.camera, level.depth, reduceColour(shot.frame.colour, 2), config.sensor);
  for (RgbdLevel& l : buildPyramid(std::move(level), 3))
    v.pyramid.push_back({l.camera, l.depth, l.intensity});
  v.weights = splitWeights(Image<std::uint8_t>(160, 120, 255), v.maps.depth);
  return v;
}

struct Terms {
  bool depth, intensity;
  double bound_m, bound_rad;  // what a 160x120 image without noise allows: a small part of a pixel
};

class TrackerRecovers : public testing::TestWithParam<Terms> {};

TEST_P(TrackerRecovers, TheKnownPoseFromPerturbedStarts) {
  FusionConfig config;
  config.tracking.use_depth = GetParam().depth;
  config.tracking.use_intensity = GetParam().intensity;
  const SE3 T_WP(Mat3::Identity(), Vec3(0, 0, -1.2));
  const SE3 T_PC = SE3::exp(twist(0.015, -0.01, 0.02, 0.01, -0.02, 0.015));
  const View model = look(T_WP, config);
  const View live = look(T_WP * T_PC, config);
  BodyModel body(config, model.maps.camera);
  const Image<std::uint8_t> none;
  fuseFrame({model.maps, model.weights.world, model.weights.object.interior, none, SE3(), 1, true},
            config, body.map, body.prediction);
  const std::vector<TrackReference> reference = makeReference(body.prediction, 3, -1.1F);
  const WeightPyramid weights = weightPyramid(live.weights.world.own, 3);
  std::mt19937_64 random(3);
  for (int i = 0; i < 8; ++i) {
    Vec6 off;
    for (int k = 0; k < 6; ++k)
      off(k) = k < 3 ? uniform(random, -0.015, 0.015) : uniform(random, -0.015, 0.015);
    const TrackResult r = alignToModel(reference, live.pyramid, weights, T_PC * SE3::exp(off),
                                       Mat6::Identity() * 0.01, 100, config);
    ASSERT_TRUE(r.accepted) << r.reason;
    const Vec6 error = (T_PC.inverse() * r.T_PC).log();
    EXPECT_LT(error.head<3>().norm(), GetParam().bound_m) << "start " << off.transpose();
    EXPECT_LT(error.tail<3>().norm(), GetParam().bound_rad) << "start " << off.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Terms, TrackerRecovers,
                         testing::Values(Terms{true, true, 0.004, 0.002},
                                         Terms{true, false, 0.004, 0.002},
                                         Terms{false, true, 0.008, 0.003}));

// A smooth surface and texture, so that every term has a gradient.
TrackLevel smoothLevel() {
  TrackLevel level{test::testCamera(64, 48).undistorted(), Image<float>(64, 48),
                   Image<float>(64, 48)};
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      level.depth(u, v) = static_cast<float>(1.5 + 0.004 * u - 0.003 * v);
      level.intensity(u, v) =
          static_cast<float>(0.5 + 0.3 * std::sin(0.21 * u) * std::cos(0.17 * v));
    }
  }
  return level;
}

class RowsAgainstDifferences : public testing::TestWithParam<bool> {};

TEST_P(RowsAgainstDifferences, GradientOfTheSquaredResidual) {
  FusionConfig config;
  config.tracking.use_depth = GetParam();
  config.tracking.use_intensity = !GetParam();
  // Constant weights: whitening and robust weights are not differentiated by Gauss-Newton.
  config.tracking.sigma_floor_m = 1.0;
  config.tracking.sigma_intensity = 1.0;
  config.tracking.gradient_intensity = 0.0;
  const TrackLevel level = smoothLevel();
  const Image<float> weight(64, 48, 1.0F);
  const SE3 T_PC = SE3::exp(twist(0.01, -0.02, 0.015, 0.01, 0.02, -0.01));
  std::mt19937_64 random(11);
  constexpr double kStep = 2e-3;  // residuals are floats of 1e-7: smaller steps lose digits
  int tested = 0;
  for (int i = 0; i < 200; ++i) {
    ReferencePoints p;
    const double z = 1.55;
    const Vec3 at = level.camera.backProject(uniform(random, 12, 50), uniform(random, 12, 36), z);
    const Vec3 n = Vec3(uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4), -1.0).normalized();
    p.x = {static_cast<float>(at.x())};
    p.y = {static_cast<float>(at.y())};
    p.z = {static_cast<float>(at.z())};
    p.nx = {static_cast<float>(n.x())};
    p.ny = {static_cast<float>(n.y())};
    p.nz = {static_cast<float>(n.z())};
    p.intensity = {0.1F};
    p.weight = {1.0F};
    const auto sumsAt = [&](const Vec6& d) {
      KernelInput in = kernelInput(level, weight, T_PC * SE3::exp(d), config);
      in.scale_depth = in.scale_intensity = 1e6F;
      KernelSums s;
      accumulateRows(p, 0, 1, in, s);
      return s;
    };
    // Look-ups must stay in one pixel cell over the steps, else the interpolant has a kink.
    const Vec3 c = T_PC.inverse() * at;
    const Eigen::Vector2d px = level.camera.project(c);
    const auto clear = [](double x) { return std::abs(2 * x - std::round(2 * x)) > 0.25; };
    if (!clear(px.x()) || !clear(px.y())) continue;
    ++tested;
    const KernelSums s = sumsAt(Vec6::Zero());
    ASSERT_GT(s.cost, 0.0);
    for (int k = 0; k < 6; ++k) {
      Vec6 d = Vec6::Zero();
      d(k) = kStep;
      const double numeric = 0.5 * (sumsAt(d).cost - sumsAt(-d).cost) / (2 * kStep);
      EXPECT_NEAR(-s.b[static_cast<std::size_t>(k)], numeric, 2e-3 * (0.02 + std::abs(numeric)))
          << "component " << k;
    }
    // One row: H = J'J and b = -J'r, so H(0,0) cost = b(0)^2.
    EXPECT_NEAR(s.H[0] * s.cost, s.b[0] * s.b[0], 1e-5 * s.H[0] * s.cost + 1e-12);
  }
  EXPECT_GE(tested, 20);
}

INSTANTIATE_TEST_SUITE_P(Terms, RowsAgainstDifferences, testing::Values(true, false));

TEST(Tracker, KeepsTheStartWhenTheModelContradicts) {
  FusionConfig config;
  const View model = look(SE3(Mat3::Identity(), Vec3(0, 0, -1.2)), config);
  BodyModel body(config, model.maps.camera);
  const Image<std::uint8_t> none;
  fuseFrame({model.maps, model.weights.world, model.weights.object.interior, none, SE3(), 1, true},
            config, body.map, body.prediction);
  View live = look(SE3(Mat3::Identity(), Vec3(0, 0, -0.7)), config);  // half a metre away
  const SE3 start = SE3::exp(twist(0.001, 0, 0, 0, 0.002, 0));
  const TrackResult r = alignToModel(makeReference(body.prediction, 3, -1.1F), live.pyramid,
                                     weightPyramid(live.weights.world.own, 3), start,
                                     Mat6::Identity() * 1e-5, 100, config);
  EXPECT_FALSE(r.accepted) << r.inliers << " inliers, share " << r.inlier_share << ", visible "
                           << r.visible_share << ", rms " << r.rms_sigma;
  EXPECT_FALSE(r.reason.empty());
  EXPECT_EQ(r.T_PC, start);
}

TEST(Tracker, KeepsTheStartWithoutPixels) {
  FusionConfig config;
  const View live = look(SE3(Mat3::Identity(), Vec3(0, 0, -1.2)), config);
  const std::vector<TrackReference> nothing =
      makeReference(Prediction::nothing(live.maps.camera), 3, -1.1F);
  const TrackResult r =
      alignToModel(nothing, live.pyramid, weightPyramid(live.weights.world.own, 3), SE3(),
                   Mat6::Identity() * 1e-4, 100, config);
  EXPECT_FALSE(r.accepted);
  EXPECT_EQ(r.inlier_share, 0);
  EXPECT_EQ(r.T_PC, SE3());
}

TEST(Tracker, RobustWeightsFallAsTheirKernelsSay) {
  for (const RobustKernel kernel :
       {RobustKernel::kHuber, RobustKernel::kTukey, RobustKernel::kCauchy}) {
    EXPECT_FLOAT_EQ(robustWeight(kernel, 0.0F), 1.0F);
    EXPECT_FLOAT_EQ(robustWeight(kernel, -2.0F), robustWeight(kernel, 2.0F));
    EXPECT_LT(robustWeight(kernel, 4.0F), robustWeight(kernel, 2.0F));
  }
  EXPECT_FLOAT_EQ(robustWeight(RobustKernel::kHuber, 2.69F), 0.5F);
  EXPECT_FLOAT_EQ(robustWeight(RobustKernel::kTukey, 5.0F), 0.0F);
  EXPECT_FLOAT_EQ(robustWeight(RobustKernel::kCauchy, 2.385F), 0.5F);
  EXPECT_THROW(kernelByName("geman"), std::invalid_argument);
}

TEST(Tracker, YoungSurfelsCountByTheirConfidence) {
  Prediction p = Prediction::nothing(test::testCamera(64, 48));
  const auto set = [&](int u, double confidence) {
    p.depth(u, 20) = 2.0F;
    p.nz(u, 20) = -1.0F;
    p.logit(u, 20) = logit(confidence);
  };
  set(10, 0.99);
  set(11, 0.90);
  set(12, 0.30);
  const std::vector<TrackReference> reference = makeReference(p, 1, logit(0.9));
  ASSERT_EQ(reference[0].points.size(), 3U);
  EXPECT_FLOAT_EQ(reference[0].points.weight[0], 1.0F);
  EXPECT_FLOAT_EQ(reference[0].points.weight[1], 1.0F);
  EXPECT_NEAR(reference[0].points.weight[2], 0.3F / 0.9F, 1e-5F);
}

}  // namespace
}  // namespace rf
