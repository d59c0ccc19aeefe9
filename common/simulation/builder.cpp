// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/builder.hpp"

namespace rf::sim {
namespace {

SE3 turned(const Vec3& centre, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vec3::UnitZ())), centre};
}

}  // namespace

int Builder::texture(Image<Rgb> picture) {
  world_.textures.emplace_back(std::move(picture));
  return static_cast<int>(world_.textures.size()) - 1;
}

int Builder::material(const Material& material) {
  world_.materials.push_back(material);
  return static_cast<int>(world_.materials.size()) - 1;
}

int Builder::plain(const Rgb& c, float infrared, float gloss) {
  Material m;
  m.tint = {linearFromSrgb(c.r), linearFromSrgb(c.g), linearFromSrgb(c.b)};
  m.infrared = infrared;
  m.gloss = gloss;
  return material(m);
}

int Builder::print(Image<Rgb> picture, float infrared, float gloss) {
  Material m;
  m.texture = texture(std::move(picture));
  m.fit = true;
  m.infrared = infrared;
  m.gloss = gloss;
  return material(m);
}

int Builder::tiling(int texture, float metres_per_texel, float infrared, float gloss) {
  Material m;
  m.texture = texture;
  m.metres_per_texel = metres_per_texel;
  const auto u = static_cast<float>(random_.uniform(0, 2000));
  const auto v = static_cast<float>(random_.uniform(0, 2000));
  m.offset = {u, v};
  m.infrared = infrared;
  m.gloss = gloss;
  return material(m);
}

Primitive& Builder::add(ShapeKind kind, const SE3& T_FP, const Vec3& half, int material) {
  Primitive p;
  p.kind = kind;
  p.T_BP = T_BF_ * T_FP;
  p.half = half;
  p.body = body_;
  p.material.fill(material);
  world_.primitives.push_back(p);
  return world_.primitives.back();
}

Primitive& Builder::solid(ShapeKind kind, int body, const SE3& T_BP, const Vec3& half,
                          int material) {
  place(body, SE3());
  return add(kind, T_BP, half, material);
}

Primitive& Builder::box(const Vec3& centre, const Vec3& half, int material, double yaw) {
  return add(ShapeKind::kBox, turned(centre, yaw), half, material);
}

Primitive& Builder::cylinder(const Vec3& centre, double radius, double half_height, int material) {
  return add(ShapeKind::kCylinder, turned(centre, 0), {radius, radius, half_height}, material);
}

Primitive& Builder::ellipsoid(const Vec3& centre, const Vec3& half, int material, double yaw) {
  return add(ShapeKind::kEllipsoid, turned(centre, yaw), half, material);
}

Primitive& Builder::rod(const Vec3& a, const Vec3& b, double radius, int material) {
  const Vec3 along = b - a;
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), along);
  return add(ShapeKind::kCylinder, {q, Vec3(0.5 * (a + b))}, {radius, radius, 0.5 * along.norm()},
             material);
}

}  // namespace rf::sim
