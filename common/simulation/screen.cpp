// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/builder.hpp"

namespace rf::sim {

void buildScreen(World& world, const Eigen::Vector2d& place, double width, double height,
                 std::uint64_t seed) {
  constexpr int kLeaves = 3;
  constexpr double kFold = 0.12;  // radians, to one side and the other
  Builder b(world, seed, 0x5C4EE4);
  Random& random = b.random();
  const double half = 0.5 * width / kLeaves;
  const int cloth = b.tiling(b.texture(paintCloth(random, 256, 256)), 0.0018F, 0.6F);
  for (int i = 0; i < kLeaves; ++i) {
    const double yaw = i % 2 == 0 ? kFold : -kFold;
    const Vec3 centre(place.x(), place.y() + (2 * i + 1 - kLeaves) * half, 0.5 * height);
    const int poster = b.print(paintPoster(random, 240, 600));
    b.box(centre, {0.015, half, 0.5 * height}, cloth, yaw).material = {poster, poster, cloth,
                                                                       cloth,  cloth,  cloth};
  }
}

}  // namespace rf::sim
