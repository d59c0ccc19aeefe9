// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace rf {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec12 = Eigen::Matrix<double, 12, 1>;
using Mat12 = Eigen::Matrix<double, 12, 12>;

/// Quaternions from outside that are further than this from unit length are refused; nearer ones
/// are normalised (files with four decimals are off by up to 1e-4).
inline constexpr double kUnitQuaternionTolerance = 1e-2;

/// Rigid transform. `T_AB` maps coordinates in frame B to frame A: p_A = T_AB * p_B.
/// Twists xi = (v, w): translation first (metres), rotation last (radians). Increments and
/// covariances are RIGHT perturbations: T <- T * exp(xi), expressed in the right-hand frame.
/// Stored as unit quaternion and translation, the same seven numbers that go over the wire, so
/// that a message round trip is exact to the bit.
struct SE3 {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();  ///< unit; Hamilton convention
  Vec3 t = Vec3::Zero();                                  ///< metres

  SE3() = default;
  SE3(const Eigen::Quaterniond& rotation, const Vec3& translation) : q(rotation), t(translation) {}
  SE3(const Mat3& rotation, const Vec3& translation)
      : q(Eigen::Quaterniond(rotation).normalized()), t(translation) {}

  Mat3 R() const { return q.toRotationMatrix(); }
  Eigen::Matrix4d matrix() const;
  SE3 inverse() const;
  SE3 operator*(const SE3& other) const;
  Vec3 operator*(const Vec3& p) const { return q * p + t; }
  bool isFinite() const { return q.coeffs().allFinite() && t.allFinite(); }
  bool operator==(const SE3& o) const { return q.coeffs() == o.q.coeffs() && t == o.t; }

  /// Exponential map of a twist (translation first), exact for every angle.
  static SE3 exp(const Vec6& xi);
  /// Inverse of exp; |w| <= pi.
  Vec6 log() const;
  /// Adjoint: T * exp(xi) = exp(Ad * xi) * T.
  Mat6 adjoint() const;
};

/// [w]_x with [w]_x p = w x p.
Mat3 skew(const Vec3& w);

/// Inverse of the right Jacobian of SE(3): log(T exp(d)) = log(T) + J_r^-1(log T) d + O(d^2).
/// Series in ad to fourth order; error below 1e-6 for |w| < 0.5 rad.
Mat6 inverseRightJacobian(const Vec6& xi);

/// Interpolates on the geodesic: a at s = 0, b at s = 1 (a * exp(s * log(a^-1 b))).
SE3 interpolate(const SE3& a, const SE3& b, double s);

}  // namespace rf
