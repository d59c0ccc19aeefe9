// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/se3.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace rf {
namespace {

class Source {
 public:
  double symmetric() { return static_cast<double>(rng_() >> 11) * 0x1p-52 - 1.0; }
  Vec3 direction() {
    Vec3 v;
    do {
      v = Vec3(symmetric(), symmetric(), symmetric());
    } while (v.norm() < 0.1);
    return v.normalized();
  }
  Vec6 twist(double translation, double angle) {
    Vec6 xi;
    xi.head<3>() = translation * direction();
    xi.tail<3>() = angle * direction();
    return xi;
  }

 private:
  std::mt19937_64 rng_{11};
};

const std::vector<double>& angles() {
  static const std::vector<double> kAngles = {0,
                                              1e-300,
                                              1e-12,
                                              1e-8,
                                              0.9e-5,
                                              1.1e-5,
                                              0.9e-3,
                                              1.1e-3,
                                              0.1,
                                              1.0,
                                              2.0,
                                              3.0,
                                              std::numbers::pi - 1e-3,
                                              std::numbers::pi - 1e-6,
                                              std::numbers::pi - 1e-9};
  return kAngles;
}

/// exp by its power series on 4x4 matrices, independent of the closed form.
Eigen::Matrix4d seriesExp(const Vec6& xi) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  A.topLeftCorner<3, 3>() = skew(xi.tail<3>());
  A.topRightCorner<3, 1>() = xi.head<3>();
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d sum = term;
  for (int k = 1; k < 60; ++k) {
    term = term * A / k;
    sum += term;
  }
  return sum;
}

TEST(Se3, ExpEqualsItsPowerSeries) {
  Source source;
  for (const double angle : angles()) {
    for (int i = 0; i < 20; ++i) {
      const Vec6 xi = source.twist(2.0, angle);
      EXPECT_LT((SE3::exp(xi).matrix() - seriesExp(xi)).norm(), 1e-12) << xi.transpose();
      EXPECT_NEAR(SE3::exp(xi).q.norm(), 1.0, 1e-15);
    }
  }
}

TEST(Se3, LogInvertsExpUpToPi) {
  Source source;
  for (const double angle : angles()) {
    for (int i = 0; i < 50; ++i) {
      const Vec6 xi = source.twist(1.5, angle);
      EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-11) << xi.transpose() << " angle " << angle;
    }
  }
}

TEST(Se3, ExpInvertsLogBeyondPi) {
  Source source;
  for (const double angle : {std::numbers::pi, 3.5, 5.0, 6.2, 9.0}) {
    const SE3 T = SE3::exp(source.twist(1.0, angle));
    const Vec6 xi = T.log();
    EXPECT_LE(xi.tail<3>().norm(), std::numbers::pi + 1e-12);
    EXPECT_LT((SE3::exp(xi).matrix() - T.matrix()).norm(), 1e-12);
  }
}

TEST(Se3, IsAGroupThatActsOnPoints) {
  Source source;
  for (int i = 0; i < 50; ++i) {
    const SE3 a = SE3::exp(source.twist(1, 2));
    const SE3 b = SE3::exp(source.twist(1, 1));
    const SE3 c = SE3::exp(source.twist(1, 3));
    const Vec3 p = source.direction();
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-14);
    EXPECT_LT((((a * b) * c).matrix() - (a * (b * c)).matrix()).norm(), 1e-14);
    EXPECT_LT((a * a.inverse()).log().norm(), 1e-14);
    EXPECT_LT((a.matrix() * a.inverse().matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-14);
    EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-14);
  }
}

TEST(Se3, TwistsAreTranslationFirst) {
  const SE3 shift = SE3::exp((Vec6() << 1, 2, 3, 0, 0, 0).finished());
  EXPECT_EQ(shift.t, Vec3(1, 2, 3));
  const SE3 turn = SE3::exp((Vec6() << 0, 0, 0, 0, 0, std::numbers::pi / 2).finished());
  EXPECT_LT((turn * Vec3(1, 0, 0) - Vec3(0, 1, 0)).norm(), 1e-15) << "right-handed about z";
}

TEST(Se3, AdjointMovesPerturbationsFromRightToLeft) {
  Source source;
  for (int i = 0; i < 50; ++i) {
    const SE3 T = SE3::exp(source.twist(2, 2.5));
    const Vec6 xi = source.twist(0.5, 0.7);
    const SE3 right = T * SE3::exp(xi);
    const SE3 left = SE3::exp(T.adjoint() * xi) * T;
    EXPECT_LT((right.matrix() - left.matrix()).norm(), 1e-13);
  }
}

TEST(Se3, InverseRightJacobianEqualsCentralDifferences) {
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 2e-6;  // the truncated series' own bound, and the differences'
  Source source;
  for (const double angle : {0.0, 1e-6, 0.01, 0.1, 0.3, 0.5}) {
    for (int i = 0; i < 20; ++i) {
      const Vec6 xi = source.twist(0.3, angle);
      const SE3 T = SE3::exp(xi);
      Mat6 numeric;
      for (int k = 0; k < 6; ++k) {
        const Vec6 d = kStep * Vec6::Unit(k);
        numeric.col(k) = ((T * SE3::exp(d)).log() - (T * SE3::exp(-d)).log()) / (2 * kStep);
      }
      EXPECT_LT((inverseRightJacobian(xi) - numeric).cwiseAbs().maxCoeff(), kTolerance)
          << xi.transpose();
    }
  }
}

TEST(Se3, InterpolationIsUniformOnTheGeodesic) {
  Source source;
  const SE3 a = SE3::exp(source.twist(1, 2));
  const Vec6 xi = source.twist(0.8, 1.2);
  const SE3 b = a * SE3::exp(xi);
  for (const double s : {0.0, 0.25, 0.5, 1.0, 1.5}) {
    EXPECT_LT(((a.inverse() * interpolate(a, b, s)).log() - s * xi).norm(), 1e-12) << s;
  }
}

}  // namespace
}  // namespace rf
