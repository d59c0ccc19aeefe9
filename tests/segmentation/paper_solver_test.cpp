// SPDX-License-Identifier: BSD-3-Clause
// Oracle: the paper mode's motion step against Ceres on the same residuals.
#include "segmentation/paper_solver.hpp"

#include <cmath>

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "values/segmentation_result.hpp"

namespace rf {
namespace {

Camera smallCamera() {
  Camera c;
  c.width = 48;
  c.height = 36;
  c.fx = 41;
  c.fy = 42;
  c.cx = 24.2;
  c.cy = 17.4;
  return c;
}

RgbdLevel scene(double shift) {
  RgbdLevel level{smallCamera(), Image<float>(48, 36), Image<float>(48, 36)};
  for (int v = 0; v < 36; ++v) {
    for (int u = 0; u < 48; ++u) {
      level.intensity(u, v) = static_cast<float>(0.5 + 0.2 * std::sin(0.3 * (u + shift)) +
                                                 0.15 * std::cos(0.25 * (v - shift)));
      level.depth(u, v) = static_cast<float>(1.5 + 0.01 * u + 0.1 * std::sin(0.2 * v));
    }
  }
  return level;
}

Vec6 twist(double a, double b, double c, double d, double e, double f) {
  Vec6 t;
  t << a, b, c, d, e, f;
  return t;
}

/// One linearised row r0 + a'd.
struct Row {
  Vec6 a;
  double r0;
  template <typename T>
  bool operator()(const T* d, T* residual) const {
    residual[0] = T(r0);
    for (int k = 0; k < 6; ++k) residual[0] += T(a(k)) * d[k];
    return true;
  }
};

struct Prior {
  PriorError error;
  double scale;
  template <typename T>
  bool operator()(const T* d, T* residual) const {
    for (int i = 0; i < 6; ++i) {
      residual[i] = T(error.e(i));
      for (int k = 0; k < 6; ++k) residual[i] += T(error.J(i, k)) * d[k];
      residual[i] *= T(scale);
    }
    return true;
  }
};

TEST(PaperSolver, MotionStepEqualsCeresOnTheSameResiduals) {
  constexpr double kFloatRows = 1e-5;  // rows are floats; the solution is of order 1e-2
  const RgbdLevel a = scene(0.0), b = scene(0.4);
  const PaperConfig config;
  PaperRows rows;
  linearisePair(a, b, SE3(), config, rows);
  normalise(config, rows, nullptr);
  const Image<std::uint8_t> label(48, 36, 0);
  LabelWeights weights{};
  weights[0] = 0.7F;
  const float c = 0.005F;
  for (const double lambda : {0.0, 1.0}) {
    const PriorError prior = priorError(SE3::exp(twist(0.01, 0, 0.02, 0.01, 0, 0.02)),
                                        twist(-0.01, 0.01, 0, 0.02, 0.01, 0));
    Vec6 delta = Vec6::Zero();
    for (int k = 0; k < 300; ++k) {
      delta = motionStep(accumulate(rows, label, weights, delta, c), prior, lambda);
    }
    ceres::Problem problem;
    double x[6] = {};
    for (int v = 0; v < 36; ++v) {
      for (int u = 0; u < 48; ++u) {
        if (!(rows.z(u, v) > 0)) continue;
        const auto add = [&](const Vec6& row, float r0) {
          problem.AddResidualBlock(
              new ceres::AutoDiffCostFunction<Row, 1, 6>(new Row{row, static_cast<double>(r0)}),
              new ceres::ScaledLoss(new ceres::CauchyLoss(static_cast<double>(c)),
                                    static_cast<double>(weights[0]), ceres::TAKE_OWNERSHIP),
              x);
        };
        add(rows.intensityRow(u, v), rows.scale_i * rows.i_r(u, v));
        add(rows.depthRow(u, v), rows.scale_d * rows.d_r(u, v));
      }
    }
    if (lambda > 0) {
      // lambda |.|^2 is 1/2 |sqrt(2 lambda) .|^2.
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Prior, 6, 6>(new Prior{prior, std::sqrt(2 * lambda)}),
          nullptr, x);
    }
    ceres::Solver::Options options;
    options.max_num_iterations = 200;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-14;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(delta(k), x[k], kFloatRows) << "lambda " << lambda << " component " << k;
    }
  }
}

TEST(PaperSolver, PriorErrorIsItsOwnLinearisation) {
  const SE3 T = SE3::exp(twist(0.03, -0.02, 0.05, 0.1, -0.2, 0.15));
  const Vec6 xi = twist(0.01, 0.02, 0.03, 0.04, 0.05, 0.06);
  const PriorError at = priorError(T, xi);
  for (int k = 0; k < 6; ++k) {
    constexpr double kStep = 1e-6;
    const Vec6 difference = (priorError(T * SE3::exp(kStep * Vec6::Unit(k)), xi).e -
                             priorError(T * SE3::exp(-kStep * Vec6::Unit(k)), xi).e) /
                            (2 * kStep);
    EXPECT_LT((difference - at.J.col(k)).norm(), 1e-6) << k;
  }
}

TEST(PaperSolver, WithoutDataTheStepIsThePriorsOrNone) {
  const NormalSums nothing;
  const PriorError prior = priorError(SE3::exp(twist(0.1, 0, 0, 0, 0, 0)), Vec6::Zero());
  EXPECT_EQ(motionStep(nothing, prior, 0), Vec6(Vec6::Zero()));
  EXPECT_LT((motionStep(nothing, prior, 1) + prior.e).norm(), 1e-6);
  NormalSums bad;
  bad.support = 100;
  bad.H = Mat6::Constant(std::nan(""));
  EXPECT_EQ(motionStep(bad, prior, 0), Vec6(Vec6::Zero()));
}

TEST(PaperSolver, WarpedScoresFollowTheMotion) {
  RgbdLevel b{smallCamera(), Image<float>(48, 36), Image<float>(48, 36, 2.0F)};
  Image<std::uint8_t> label(48, 36, 0);
  for (int v = 0; v < 36; ++v) {
    for (int u = 24; u < 48; ++u) label(u, v) = 1;
  }
  Image<float> previous(48, 36, 1.0F);
  for (int v = 0; v < 36; ++v) {
    for (int u = 0; u < 24; ++u) previous(u, v) = 0.0F;
  }
  const std::vector<float> still = warpScores(b, label, 2, SE3(), previous, b.camera);
  EXPECT_EQ(still[0], 0.0F);
  EXPECT_EQ(still[1], 1.0F);
  // Everything looks up 30 pixels further left: cluster 1 finds 0 or leaves the image.
  const SE3 left(Mat3(Mat3::Identity()), Vec3(-30 * 2.0 / 41, 0, 0));
  const std::vector<float> moved = warpScores(b, label, 2, left, previous, b.camera);
  EXPECT_EQ(moved[0], 1.0F);  // all left the image: assumed static
  EXPECT_EQ(moved[1], 0.0F);
}

TEST(PaperSolver, OutlierRuleFindsTheBadCluster) {
  ClusterResiduals r(5);
  const std::vector<int> sizes(5, 100);
  Adjacency adjacency(5);
  adjacency.join(0, 1);
  for (std::size_t k = 0; k < 5; ++k) {
    r.pixels[k] = 100;
    r.abs_s[k] = 2 * 100 * (k == 3 ? 0.04 : 0.004);
    r.depth_s[k] = 100 * (k == 3 ? 0.3 : 0.004);
  }
  const float c = static_cast<float>(0.5 * (4 * 0.004 + 0.04) / 5);
  const std::vector<float> b = outlierScores(r, sizes, adjacency, c, PaperConfig{}, 1.5);
  for (std::size_t k = 0; k < 5; ++k) {
    if (k == 3) {
      EXPECT_LT(b[k], 0.3F);
    } else {
      EXPECT_GT(b[k], 0.9F);
    }
  }
}

}  // namespace
}  // namespace rf
