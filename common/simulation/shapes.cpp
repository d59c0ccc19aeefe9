// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rf::sim {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

ShapeHit hitBox(const Vector3f& half, const Vector3f& o, const Vector3f& d, float near) {
  float enter = near;
  float leave = 1e9F;
  int axis = -1;
  for (int i = 0; i < 3; ++i) {
    const float inverse = 1.0F / d[i];  // infinities compare as they should
    const float a = (-half[i] - o[i]) * inverse;
    const float b = (half[i] - o[i]) * inverse;
    const float low = std::min(a, b);
    if (low > enter) {
      enter = low;
      axis = i;
    }
    leave = std::min(leave, std::max(a, b));
  }
  if (axis < 0 || enter > leave) return {};
  return {enter, 2 * axis + (d[axis] < 0 ? 1 : 0)};
}

ShapeHit hitCylinder(const Vector3f& half, const Vector3f& o, const Vector3f& d, float near) {
  const float a = d.x() * d.x() + d.y() * d.y();
  const float b = o.x() * d.x() + o.y() * d.y();
  const float c = o.x() * o.x() + o.y() * o.y() - half.x() * half.x();
  const float root = b * b - a * c;
  if (root < 0) return {};
  const float side = (-b - std::sqrt(root)) / a;
  if (side > near && std::abs(o.z() + side * d.z()) <= half.z()) return {side, 0};
  const float sign = d.z() < 0 ? 1.0F : -1.0F;
  const float cap = (sign * half.z() - o.z()) / d.z();
  const float x = o.x() + cap * d.x();
  const float y = o.y() + cap * d.y();
  if (!(cap > near) || x * x + y * y > half.x() * half.x()) return {};
  return {cap, sign > 0 ? 2 : 1};
}

ShapeHit hitEllipsoid(const Vector3f& half, const Vector3f& o, const Vector3f& d, float near) {
  const Vector3f so = o.cwiseQuotient(half);
  const Vector3f sd = d.cwiseQuotient(half);
  const float a = sd.squaredNorm();
  const float b = so.dot(sd);
  const float root = b * b - a * (so.squaredNorm() - 1.0F);
  if (root < 0) return {};
  const float t = (-b - std::sqrt(root)) / a;
  return t > near ? ShapeHit{t, 0} : ShapeHit{};
}

}  // namespace

ShapeHit intersect(ShapeKind kind, const Vector3f& half, const Vector3f& o, const Vector3f& d,
                   float near) {
  switch (kind) {
    case ShapeKind::kBox:
      return hitBox(half, o, d, near);
    case ShapeKind::kCylinder:
      return hitCylinder(half, o, d, near);
    case ShapeKind::kEllipsoid:
      return hitEllipsoid(half, o, d, near);
  }
  return {};
}

Vector3f surfaceNormal(ShapeKind kind, const Vector3f& half, int face, const Vector3f& p) {
  if (kind == ShapeKind::kBox) {
    return Vector3f::Unit(face / 2) * (face % 2 == 1 ? 1.0F : -1.0F);
  }
  if (kind == ShapeKind::kCylinder) {
    if (face == 0) return Vector3f(p.x(), p.y(), 0).normalized();
    return Vector3f::UnitZ() * (face == 2 ? 1.0F : -1.0F);
  }
  return p.cwiseQuotient(half.cwiseProduct(half)).normalized();
}

Vector2f surfaceCoordinates(ShapeKind kind, const Vector3f& half, int face, const Vector3f& p) {
  const Vector3f q = p + half;  // from the lower corner
  if (kind == ShapeKind::kBox) {
    switch (face) {
      case 0:
        return {2 * half.y() - q.y(), 2 * half.z() - q.z()};
      case 1:
        return {q.y(), 2 * half.z() - q.z()};
      case 2:
        return {q.x(), 2 * half.z() - q.z()};
      case 3:
        return {2 * half.x() - q.x(), 2 * half.z() - q.z()};
      case 4:
        return {q.x(), q.y()};
      default:
        return {q.x(), 2 * half.y() - q.y()};
    }
  }
  if (kind == ShapeKind::kCylinder && face != 0) return {q.x(), q.y()};
  const float angle = std::atan2(p.y(), p.x()) + std::numbers::pi_v<float>;
  return {angle * half.x(), 2 * half.z() - q.z()};
}

Vector2f surfaceExtent(ShapeKind kind, const Vector3f& half, int face) {
  if (kind == ShapeKind::kBox) {
    const int axis = face / 2;
    if (axis == 0) return {2 * half.y(), 2 * half.z()};
    if (axis == 1) return {2 * half.x(), 2 * half.z()};
    return {2 * half.x(), 2 * half.y()};
  }
  if (kind == ShapeKind::kCylinder && face != 0) return {2 * half.x(), 2 * half.x()};
  return {2 * std::numbers::pi_v<float> * half.x(), 2 * half.z()};
}

}  // namespace rf::sim
