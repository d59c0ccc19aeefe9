// SPDX-License-Identifier: BSD-3-Clause
// Oracle: the coupled motion step against Ceres on independently coded residuals.
#include <gtest/gtest.h>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "segmentation/joint_solver.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

/// A plane of values that is linear in the pixel: bilinear look-ups are then exact.
struct Plane {
  double at0, du, dv;
  template <typename T>
  T operator()(const T& u, const T& v) const {
    return T(at0) + T(du) * u + T(dv) * v;
  }
};

struct Scene {
  Camera camera;
  Plane intensity_a{0.3, 0.0040, -0.0020}, intensity_b{0.302, 0.0040, -0.0020};
  Plane depth_a{1.6, 0.004, 0.003}, depth_b{1.601, 0.004, 0.003};
  TermLevel a, b;
  Image<std::uint8_t> label;

  Scene() {
    camera.width = 40;
    camera.height = 30;
    camera.fx = 33;
    camera.fy = 34;
    camera.cx = 20.1;
    camera.cy = 14.3;
    a = level(intensity_a, depth_a);
    b = level(intensity_b, depth_b);
    label = Image<std::uint8_t>(40, 30);
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u) label(u, v) = u < 18 ? 0 : 1;
    }
  }

  TermLevel level(const Plane& intensity, const Plane& depth) const {
    RgbdLevel out{camera, Image<float>(40, 30), Image<float>(40, 30)};
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u) {
        out.intensity(u, v) = static_cast<float>(intensity(double(u), double(v)));
        out.depth(u, v) = static_cast<float>(depth(double(u), double(v)));
      }
    }
    return makeTermLevel(out);
  }
};

/// T = start * (Exp(w), v).
SE3 moved(const SE3& start, const double* x) {
  double q[4];
  ceres::AngleAxisToQuaternion(x + 3, q);
  return start * SE3(Eigen::Quaterniond(q[0], q[1], q[2], q[3]), Vec3(x[0], x[1], x[2]));
}

struct PixelResidual {
  const Scene& scene;
  const SE3& start;
  int u, v;
  bool depth;
  double weight;

  template <typename T>
  bool operator()(const T* x, T* residual) const {
    const double z = scene.depth_b(double(u), double(v));
    const Vec3 p_b = scene.camera.backProject(u, v, z);
    const T p[3] = {T(p_b.x()), T(p_b.y()), T(p_b.z())};
    T q[3];
    ceres::AngleAxisRotatePoint(x + 3, p, q);
    for (int k = 0; k < 3; ++k) q[k] += x[k];
    const Mat3 R = start.R();
    T a[3];
    for (int k = 0; k < 3; ++k)
      a[k] = R(k, 0) * q[0] + R(k, 1) * q[1] + R(k, 2) * q[2] + start.t[k];
    const T ua = scene.camera.fx * a[0] / a[2] + scene.camera.cx;
    const T va = scene.camera.fy * a[1] / a[2] + scene.camera.cy;
    residual[0] = depth ? weight * (scene.depth_a(ua, va) - a[2])
                        : weight * (scene.intensity_b(T(u), T(v)) - scene.intensity_a(ua, va));
    return true;
  }
};

struct PriorResidual {
  const JointPrior& prior;
  const SE3& start_s;
  const SE3& start_d;
  bool object;
  bool operator()(const double* x_s, const double* x_d, double* residual) const {
    const SE3 T_s = moved(start_s, x_s);
    const SE3 T_d = moved(start_d, x_d);
    const Vec6 e = object ? prior.objectError(T_s, T_d) : prior.staticError(T_s);
    const Mat6 L = (object ? prior.information_d : prior.information_s).llt().matrixU();
    Eigen::Map<Vec6>{residual} = L * e;
    return true;
  }
};

TEST(JointSolver, MotionsEqualCeres) {
  const Scene scene;
  ImageTermParams terms;
  JointParams params;
  params.step_tolerance = 1e-12;
  params.cauchy_floor = 2.0;  // the same scale for both solvers
  params.cauchy_factor = 1e-6;
  JointPrior prior;
  prior.T_s = SE3::exp((Vec6() << 0.004, -0.002, 0.003, 0.002, 0.003, -0.002).finished());
  prior.information_s = Vec6(1e5, 1e5, 1e5, 1e4, 1e4, 1e4).asDiagonal();
  prior.object = JointPrior::Object::kRelative;
  prior.object_motion = SE3::exp((Vec6() << -0.003, 0.001, 0.002, 0.001, -0.002, 0.004).finished());
  prior.information_d = Vec6(2e5, 2e5, 2e5, 3e4, 3e4, 3e4).asDiagonal();

  JointState start;
  start.T_s = prior.T_s;
  start.T_d = prior.expectedObject(prior.T_s);
  start.gamma = {0.9F, 0.2F};
  const ScorePrior scores{{1.0F, 1.0F}, {1.0F, 1.0F}};
  const Adjacency adjacency(2);
  const JointLevel level{&scene.a, &scene.b, &scene.label};
  const JointFit fit = solveJoint(level, start, prior, scores, adjacency, params, terms, 30, true);

  double x_s[6] = {0};
  double x_d[6] = {0};
  ceres::Problem problem;
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      const auto i = static_cast<std::size_t>(v * 40 + u);
      const double gamma = start.gamma[scene.label(u, v)];
      for (const bool object : {false, true}) {
        const BodyTerms& body = object ? fit.terms_d : fit.terms_s;
        if (body.valid[i] == 0) continue;
        for (const bool depth : {false, true}) {
          // The weight is the project's (it depends on gradients, constant here up to the border).
          const double du = 0.5 * (scene.a.depth_u(20, 15) + scene.b.depth_u(u, v));
          const double dv = 0.5 * (scene.a.depth_v(20, 15) + scene.b.depth_v(u, v));
          const double iu = 0.5 * (scene.a.intensity_u(20, 15) + scene.b.intensity_u(u, v));
          const double iv = 0.5 * (scene.a.intensity_v(20, 15) + scene.b.intensity_v(u, v));
          const double dz = scene.b.depth(u, v) - 0.4;
          const double sigma = terms.depth_sigma_base_m + terms.depth_sigma_quadratic * dz * dz;
          const double weight = depth
                                    ? 1 / std::sqrt(2 * sigma * sigma + 0.25 * (du * du + dv * dv))
                                    : 1 / std::sqrt(4e-4 + 0.25 * (iu * iu + iv * iv));
          const double g = (object ? 1 - gamma : gamma) / (params.kappa * 4.0);
          problem.AddResidualBlock(
              new ceres::AutoDiffCostFunction<PixelResidual, 1, 6>(
                  new PixelResidual{scene, object ? start.T_d : start.T_s, u, v, depth, weight}),
              new ceres::ScaledLoss(new ceres::CauchyLoss(2.0), g, ceres::TAKE_OWNERSHIP),
              object ? x_d : x_s);
        }
      }
    }
  }
  for (const bool object : {false, true}) {
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<PriorResidual, ceres::CENTRAL, 6, 6, 6>(
            new PriorResidual{prior, start.T_s, start.T_d, object}),
        new ceres::HuberLoss(kPriorHuber), x_s, x_d);
  }
  ceres::Solver::Options options;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  // Border pixels of A have zero gradients, which changes their weights a little: tolerance in m,
  // rad.
  constexpr double kTolerance = 3e-4;
  EXPECT_GT((start.T_s.inverse() * fit.state.T_s).log().norm(), 3 * kTolerance)
      << "the solve did nothing";
  EXPECT_LT((moved(start.T_s, x_s).inverse() * fit.state.T_s).log().norm(), kTolerance)
      << summary.BriefReport();
  EXPECT_LT((moved(start.T_d, x_d).inverse() * fit.state.T_d).log().norm(), kTolerance)
      << summary.BriefReport();
}

TEST(JointSolver, BodyWithoutPixelsFollowsItsPrior) {
  const Scene scene;
  JointPrior prior;
  prior.information_s = 1e4 * Mat6::Identity();
  prior.object = JointPrior::Object::kRelative;
  prior.object_motion = SE3::exp((Vec6() << 0.01, 0, 0, 0, 0.02, 0).finished());
  prior.information_d = 1e5 * Mat6::Identity();
  JointState start;
  start.gamma = {1.0F, 1.0F};
  start.T_d = SE3();
  const JointFit fit =
      solveJoint({&scene.a, &scene.b, &scene.label}, start, prior, {{1, 1}, {1, 1}}, Adjacency(2),
                 JointParams{}, ImageTermParams{}, 10, true);
  EXPECT_TRUE(fit.state.T_d.isFinite());
  EXPECT_LT(prior.objectError(fit.state.T_s, fit.state.T_d).norm(), 1e-3);
}

}  // namespace
}  // namespace rf
