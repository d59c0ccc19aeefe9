// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/se3.hpp"

#include <cmath>

namespace rf {
namespace {
constexpr double kSmallAngle = 1e-5;  // below this the series is exact to double precision
}

Mat3 skew(const Vec3& w) {
  Mat3 m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

Eigen::Matrix4d SE3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = R();
  m.topRightCorner<3, 1>() = t;
  return m;
}

SE3 SE3::inverse() const {
  const Eigen::Quaterniond qi = q.conjugate();
  return {qi, -(qi * t)};
}

SE3 SE3::operator*(const SE3& other) const { return {(q * other.q).normalized(), q * other.t + t}; }

SE3 SE3::exp(const Vec6& xi) {
  const Vec3 v = xi.head<3>();
  const Vec3 w = xi.tail<3>();
  const double theta = w.norm();
  double a = 0.0;  // (1 - cos) / theta^2
  double b = 0.0;  // (theta - sin) / theta^3
  Eigen::Quaterniond rotation;
  if (theta < kSmallAngle) {
    a = 0.5 - theta * theta / 24.0;
    b = 1.0 / 6.0 - theta * theta / 120.0;
    rotation = Eigen::Quaterniond(1.0 - theta * theta / 8.0, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z());
    rotation.normalize();
  } else {
    const double half_sin = std::sin(0.5 * theta);
    a = 2.0 * half_sin * half_sin / (theta * theta);
    b = (theta - std::sin(theta)) / (theta * theta * theta);
    const Vec3 axis = w * (half_sin / theta);
    rotation = Eigen::Quaterniond(std::cos(0.5 * theta), axis.x(), axis.y(), axis.z());
  }
  const Vec3 wv = w.cross(v);
  return {rotation, v + a * wv + b * w.cross(wv)};
}

Vec6 SE3::log() const {
  const Vec3 im = q.w() < 0 ? Vec3(-q.vec()) : Vec3(q.vec());
  const double re = std::abs(q.w());
  const double n = im.norm();
  const double theta = 2.0 * std::atan2(n, re);
  const Vec3 w = n < 0.5 * kSmallAngle ? Vec3(im * (2.0 / re)) : Vec3(im * (theta / n));
  double c = 1.0 / 12.0;  // 1/theta^2 - (1 + cos) / (2 theta sin)
  if (theta > 1e-3) {
    c = 1.0 / (theta * theta) - 0.5 / (theta * std::tan(0.5 * theta));
  } else {
    c += theta * theta / 720.0;
  }
  const Vec3 wt = w.cross(t);
  Vec6 xi;
  xi.head<3>() = t - 0.5 * wt + c * w.cross(wt);
  xi.tail<3>() = w;
  return xi;
}

Mat6 SE3::adjoint() const {
  Mat6 ad = Mat6::Zero();
  const Mat3 rotation = R();
  ad.topLeftCorner<3, 3>() = rotation;
  ad.bottomRightCorner<3, 3>() = rotation;
  ad.topRightCorner<3, 3>() = skew(t) * rotation;
  return ad;
}

Mat6 inverseRightJacobian(const Vec6& xi) {
  Mat6 ad = Mat6::Zero();
  ad.topLeftCorner<3, 3>() = skew(xi.tail<3>());
  ad.bottomRightCorner<3, 3>() = skew(xi.tail<3>());
  ad.topRightCorner<3, 3>() = skew(xi.head<3>());
  const Mat6 ad2 = ad * ad;
  return Mat6::Identity() + 0.5 * ad + ad2 / 12.0 - ad2 * ad2 / 720.0;
}

SE3 interpolate(const SE3& a, const SE3& b, double s) {
  return a * SE3::exp(s * (a.inverse() * b).log());
}

}  // namespace rf
