// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulation/builder.hpp"

namespace rf::sim {
namespace {

constexpr double kTexelsPerMetre = 800;

Image<Rgb> cartonSide(Random& random, double width, double height) {
  const auto texels = [](double metres) {
    return std::clamp(static_cast<int>(metres * kTexelsPerMetre), 96, 900);
  };
  return paintCarton(random, texels(width), texels(height));
}

/// One carton with different pictures on its sides.
void carton(Builder& b, const Vec3& centre, const Vec3& half, double yaw) {
  Random& random = b.random();
  const int front = b.print(cartonSide(random, 2 * half.y(), 2 * half.z()));
  const int side = b.print(cartonSide(random, 2 * half.x(), 2 * half.z()));
  const int top = b.print(cartonSide(random, 2 * half.x(), 2 * half.y()));
  b.box(centre, half, front, yaw).material = {front, front, side, side, top, top};
}

void wheels(Builder& b, const Vec3& half) {
  const int rubber = b.plain({28, 28, 30}, 0.25F);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vec3 hub(x * (half.x() - 0.06), y * half.y(), 0.045);
      b.rod(hub - Vec3(0, 0.02, 0), hub + Vec3(0, 0.02, 0), 0.045, rubber);
    }
  }
}

}  // namespace

void buildStack(World& world, int body, const StackSize& size, std::uint64_t seed) {
  Builder b(world, seed, 0x57AC0000ULL + static_cast<std::uint64_t>(body));
  b.place(body, SE3());
  Random& random = b.random();
  const Vec3 half = 0.5 * size.extent;
  const double base = size.carrier_height;
  b.box({0, 0, 0.5 * base + 0.02}, {half.x() * 0.95, half.y() * 0.95, 0.5 * base - 0.02},
        b.plain({205, 95, 35}, 0.5F, 0.1F));
  wheels(b, half);
  const int layers = 3;
  double z = base;
  for (int i = 0; i < layers; ++i) {
    const double height = i + 1 == layers ? base + size.extent.z() - z
                                          : size.extent.z() / layers * random.uniform(0.8, 1.15);
    const Vec3 layer(half.x() * (i == 0 || size.flush ? 1.0 : random.uniform(0.9, 1.0)),
                     half.y() * (i == 0 || size.flush ? 1.0 : random.uniform(0.88, 1.0)),
                     0.5 * height);
    const double yaw = i == 0 || size.flush ? 0.0 : random.uniform(-0.03, 0.03);
    if (i == 1) {  // two cartons side by side
      const double split = random.uniform(0.4, 0.6);
      const double left = layer.y() * split;
      carton(b, {0, left - layer.y(), z + layer.z()}, {layer.x(), left, layer.z()}, yaw);
      carton(b, {0, left, z + layer.z()}, {layer.x() * 0.97, layer.y() - left, layer.z()}, yaw);
    } else {
      carton(b, {0, 0, z + layer.z()}, layer, yaw);
    }
    z += height;
  }
}

void buildCarton(World& world, int body, const Vec3& half, std::uint64_t seed) {
  Builder b(world, seed, 0xCA2700ULL + static_cast<std::uint64_t>(body));
  b.place(body, SE3());
  carton(b, Vec3::Zero(), half, 0);
}

void buildHeldCarton(World& world, int body, std::uint64_t seed) {
  Builder b(world, seed, 0xCA270000ULL + static_cast<std::uint64_t>(body));
  b.place(body, SE3());
  carton(b, Vec3::Zero(), {0.08, 0.12, 0.15}, 0);
  const int skin = b.plain({205, 155, 130}, 0.75F);
  const int sleeve = b.tiling(b.texture(paintCloth(b.random(), 256, 256)), 0.0012F, 0.55F);
  b.ellipsoid({0, 0.02, -0.165}, {0.045, 0.05, 0.035}, skin);
  for (int finger = 0; finger < 4; ++finger) {
    const double y = -0.035 + 0.027 * finger;
    b.rod({-0.075, y, -0.16}, {-0.088, y, -0.095}, 0.011, skin);
    b.ellipsoid({-0.088, y, -0.092}, {0.011, 0.011, 0.014}, skin);
    b.rod({0.0, y, -0.17}, {-0.075, y, -0.162}, 0.011, skin);
  }
  b.rod({0.02, 0.02, -0.17}, {0.10, 0.06, -0.30}, 0.034, skin);
  b.rod({0.10, 0.06, -0.30}, {0.30, 0.16, -0.80}, 0.052, sleeve);
}

}  // namespace rf::sim
