// SPDX-License-Identifier: BSD-3-Clause
// Rows of the paper mode against differences, and its sums against plain loops over the rows.
#include "segmentation/paper_rows.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

Camera smallCamera() {
  Camera c;
  c.width = 60;
  c.height = 44;
  c.fx = 51;
  c.fy = 53;
  c.cx = 30.2;
  c.cy = 21.4;
  return c;
}

/// Smooth textured surface; `phase` moves the pattern between frames.
RgbdLevel scene(double phase) {
  RgbdLevel level{smallCamera(), Image<float>(60, 44), Image<float>(60, 44)};
  for (int v = 0; v < 44; ++v) {
    for (int u = 0; u < 60; ++u) {
      level.intensity(u, v) =
          static_cast<float>(0.5 + 0.2 * std::sin(0.09 * u + phase) + 0.15 * std::cos(0.07 * v));
      level.depth(u, v) = static_cast<float>(1.5 + 0.006 * u + 0.004 * v + 0.002 * phase);
    }
  }
  return level;
}

Vec6 twist(double a, double b, double c, double d, double e, double f) {
  Vec6 t;
  t << a, b, c, d, e, f;
  return t;
}

TEST(PaperRows, AreTheDerivativesOfTheResiduals) {
  // Averaged gradients are second-order accurate for small motions; bilinear look-ups of a curved
  // pattern and the edge-preserving mean of two differences add the rest.
  constexpr double kModelError = 0.05;
  const RgbdLevel a = scene(0.0), b = scene(0.03);
  const SE3 T = SE3::exp(twist(0.002, -0.001, 0.003, 0.001, 0.002, -0.001));
  const PaperConfig config;
  PaperRows at, plus, minus;
  linearisePair(a, b, T, config, at);
  constexpr double kStep = 2e-4;
  for (int k = 0; k < 6; ++k) {
    linearisePair(a, b, T * SE3::exp(kStep * Vec6::Unit(k)), config, plus);
    linearisePair(a, b, T * SE3::exp(-kStep * Vec6::Unit(k)), config, minus);
    double error_i = 0, size_i = 0, error_d = 0, size_d = 0;
    for (int v = 3; v < 41; ++v) {
      for (int u = 3; u < 57; ++u) {
        if (!(at.z(u, v) > 0 && plus.z(u, v) > 0 && minus.z(u, v) > 0)) continue;
        const auto value = [&](const Image<float>& r, const Image<float>& w) {
          return static_cast<double>(r(u, v)) / static_cast<double>(w(u, v));
        };
        const double di = (value(plus.i_r, plus.i_w) - value(minus.i_r, minus.i_w)) / (2 * kStep);
        const double dd = (value(plus.d_r, plus.d_w) - value(minus.d_r, minus.d_w)) / (2 * kStep);
        const double ji = at.intensityRow(u, v)(k) / static_cast<double>(at.i_w(u, v));
        const double jd = at.depthRow(u, v)(k) / static_cast<double>(at.d_w(u, v));
        error_i += (di - ji) * (di - ji);
        size_i += di * di;
        error_d += (dd - jd) * (dd - jd);
        size_d += dd * dd;
      }
    }
    ASSERT_GT(size_i, 0);
    ASSERT_GT(size_d, 0);
    EXPECT_LT(std::sqrt(error_i / size_i), kModelError) << "intensity, component " << k;
    EXPECT_LT(std::sqrt(error_d / size_d), kModelError) << "depth, component " << k;
  }
}

TEST(PaperRows, RowFormulaEqualsCentralDifferencesOfThePixelsMotion) {
  // A static point p moves to exp(-d) p in B; linear images make the residual's change exact.
  std::mt19937_64 random(3);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-53 - 0.5; };
  PaperRows rows;
  rows.camera = smallCamera();
  for (auto* plane : {&rows.z, &rows.i_a, &rows.i_b, &rows.d_a, &rows.d_b, &rows.d_w}) {
    *plane = Image<float>(60, 44);
  }
  for (int round = 0; round < 200; ++round) {
    const int u = static_cast<int>(random() % 60), v = static_cast<int>(random() % 44);
    const double z = 1.5 + uniform(), gu = uniform(), gv = uniform(), hu = uniform(),
                 hv = uniform();
    const Camera& c = rows.camera;
    rows.z(u, v) = static_cast<float>(z);
    rows.i_a(u, v) = static_cast<float>(gu * c.fx / z);
    rows.i_b(u, v) = static_cast<float>(gv * c.fy / z);
    rows.d_a(u, v) = static_cast<float>(hu * c.fx / z);
    rows.d_b(u, v) = static_cast<float>(hv * c.fy / z);
    rows.d_w(u, v) = 1;
    const Vec3 p = c.backProject(u, v, z);
    const auto residuals = [&](const Vec6& d) {
      const Vec3 moved = SE3::exp(-d) * p;
      const Eigen::Vector2d shift = c.project(moved) - c.project(p);
      return Eigen::Vector2d(gu * shift.x() + gv * shift.y(),
                             hu * shift.x() + hv * shift.y() - (moved.z() - p.z()));
    };
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-5;
      const Eigen::Vector2d difference =
          (residuals(kStep * Vec6::Unit(k)) - residuals(-kStep * Vec6::Unit(k))) / (2 * kStep);
      const double size = 1 + std::abs(difference.x()) + std::abs(difference.y());
      ASSERT_NEAR(rows.intensityRow(u, v)(k), difference.x(), 2e-6 * size) << k;
      ASSERT_NEAR(rows.depthRow(u, v)(k), difference.y(), 2e-6 * size) << k;
    }
  }
}

struct Pair {
  RgbdLevel a = scene(0.0), b = scene(0.1);
  PaperConfig config;
  PaperRows rows;
  Image<std::uint8_t> label{60, 44};
  LabelWeights weights{};
  Vec6 delta = twist(0.001, 0.002, -0.001, 0.002, -0.003, 0.001);
  float c = 0.01F;

  Pair() {
    a.depth(20, 20) = 0;
    b.depth(40, 30) = 0;
    linearisePair(a, b, SE3(), config, rows);
    normalise(config, rows, nullptr);
    for (int v = 0; v < 44; ++v) {
      for (int u = 0; u < 60; ++u) {
        label(u, v) = b.depth(u, v) > 0 ? static_cast<std::uint8_t>(u / 20) : kNoCluster;
      }
    }
    weights[0] = 1.0F;
    weights[1] = 0.3F;
  }
};

TEST(PaperRows, SumsEqualPlainLoops) {
  constexpr double kFloatSums = 2e-4;
  const Pair s;
  const NormalSums sums = accumulate(s.rows, s.label, s.weights, s.delta, s.c);
  Mat6 H = Mat6::Zero();
  Vec6 b = Vec6::Zero();
  double weight = 0, squares = 0, support = 0;
  std::vector<double> logs(3), absolute(3), pixels(3);
  for (int v = 0; v < 44; ++v) {
    for (int u = 0; u < 60; ++u) {
      if (!(s.rows.z(u, v) > 0)) continue;
      const double g = static_cast<double>(s.weights[s.label(u, v)]);
      const Vec6 rows[2] = {s.rows.intensityRow(u, v), s.rows.depthRow(u, v)};
      const double r0[2] = {static_cast<double>(s.rows.scale_i * s.rows.i_r(u, v)),
                            static_cast<double>(s.rows.scale_d * s.rows.d_r(u, v))};
      support += g;
      pixels[s.label(u, v)] += 1;
      for (int k = 0; k < 2; ++k) {
        const double r = r0[k] + rows[k].dot(s.delta);
        const double ratio = r / static_cast<double>(s.c);
        const double w = g / (1 + ratio * ratio);
        H += w * rows[k] * rows[k].transpose();
        b -= w * rows[k] * r0[k];
        weight += w;
        squares += w * r * r;
        logs[s.label(u, v)] += std::log1p(ratio * ratio);
        absolute[s.label(u, v)] += std::abs(r);
      }
    }
  }
  EXPECT_LT((sums.H - H).norm(), kFloatSums * H.norm());
  EXPECT_LT((sums.b - b).norm(), kFloatSums * b.norm());
  EXPECT_NEAR(sums.weight, weight, kFloatSums * weight);
  EXPECT_NEAR(sums.squares, squares, kFloatSums * squares);
  EXPECT_NEAR(sums.support, support, kFloatSums * support);
  const ClusterResiduals residuals =
      evaluateClusters(s.rows, s.delta, nullptr, Vec6::Zero(), s.label, 3, s.c);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(residuals.pixels[k], pixels[k]);
    EXPECT_NEAR(residuals.log_s[k], logs[k], kFloatSums * logs[k]);
    EXPECT_NEAR(residuals.abs_s[k], absolute[k], kFloatSums * absolute[k]);
  }
}

TEST(PaperRows, PairsAreRefusedAtHolesBordersAndOccluders) {
  Pair s;
  EXPECT_EQ(s.rows.z(40, 30), 0.0F);  // no depth in B
  EXPECT_EQ(s.rows.z(20, 20), 0.0F);  // look-up beside a hole of A
  EXPECT_EQ(s.rows.z(0, 10), 0.0F);
  EXPECT_EQ(s.rows.z(59, 10), 0.0F);
  EXPECT_GT(s.rows.z(10, 10), 0.0F);
  RgbdLevel near = s.a;
  for (float& d : near.depth) d = d > 0 ? d - 0.5F : 0.0F;
  linearisePair(near, s.b, SE3(), s.config, s.rows);
  for (float z : s.rows.z) ASSERT_EQ(z, 0.0F);
}

TEST(PaperRows, EmptyDepthAndOddSizes) {
  Pair s;
  for (float& d : s.b.depth) d = 0;
  linearisePair(s.a, s.b, SE3(), s.config, s.rows);
  normalise(s.config, s.rows, nullptr);
  const NormalSums sums = accumulate(s.rows, s.label, s.weights, s.delta, s.c);
  EXPECT_EQ(sums.support, 0);
  EXPECT_TRUE(sums.H.allFinite());
}

TEST(PaperRows, SameBitsForEveryThreadCount) {
  const Pair s;
  setThreads(1);
  const NormalSums one = accumulate(s.rows, s.label, s.weights, s.delta, s.c);
  setThreads(2);
  const NormalSums two = accumulate(s.rows, s.label, s.weights, s.delta, s.c);
  setThreads(1);
  EXPECT_EQ(one.H, two.H);
  EXPECT_EQ(one.b, two.b);
}

}  // namespace
}  // namespace rf
