// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "simulation/builder.hpp"

namespace rf::sim {
namespace {

/// Materials that several things share.
struct Palette {
  int wood_light, wood_dark, white, metal, black, plaster, leaves;
  std::vector<int> books;
  std::vector<int> posters;
  std::vector<int> cartons;
  std::vector<int> pages;
};

int pick(Random& random, const std::vector<int>& from) {
  return from[static_cast<std::size_t>(random.below(static_cast<int>(from.size())))];
}

Palette paintPalette(Builder& b) {
  Random& r = b.random();
  Palette p;
  p.wood_light =
      b.tiling(b.texture(paintWood(r, 512, 512, {214, 178, 132})), 0.0018F, 0.65F, 0.06F);
  p.wood_dark = b.tiling(b.texture(paintWood(r, 512, 512, {128, 86, 56})), 0.0018F, 0.5F, 0.06F);
  p.white = b.plain({232, 230, 224}, 0.75F, 0.08F);
  p.metal = b.plain({150, 152, 156}, 0.4F, 0.25F);
  p.black = b.plain({26, 26, 28}, 0.12F, 0.2F);
  p.plaster = b.tiling(b.texture(paintPlaster(r, 768, 768, randomColour(r, 195, 240, 0.14))),
                       0.003F, 0.75F);
  p.leaves = b.tiling(b.texture(paintLeaves(r, 256, 256)), 0.0012F, 0.7F);
  for (int i = 0; i < 14; ++i) p.books.push_back(b.print(paintBookSpine(r, 48, 300)));
  for (int i = 0; i < 9; ++i) p.posters.push_back(b.print(paintPoster(r, 420, 594), 0.65F, 0.05F));
  for (int i = 0; i < 6; ++i) p.cartons.push_back(b.print(paintCarton(r, 400, 300)));
  for (int i = 0; i < 4; ++i) p.pages.push_back(b.print(paintPage(r, 300, 424), 0.75F));
  return p;
}

/// A thing against a wall. Its frame: x along the wall (centre 0), y out of the wall into the room
/// (0 at the wall), z up.
using Thing = void (*)(Builder&, const Palette&, double width);

void bookRow(Builder& b, const Palette& p, double left, double right, double depth, double floor,
             double room_above) {
  Random& r = b.random();
  double x = left;
  while (x < right - 0.05) {
    if (r.chance(0.12)) {  // a gap, sometimes with a thing in it
      const double gap = std::min(r.uniform(0.06, 0.16), right - x);
      if (r.chance(0.5) && gap > 0.08) {
        b.cylinder({x + gap / 2, depth * 0.5, floor + 0.06}, 0.035, 0.06,
                   b.plain(randomColour(r, 60, 230, 0.8)));
      }
      x += gap;
      continue;
    }
    const double width = r.uniform(0.022, 0.055);
    const double height = std::min(r.uniform(0.19, 0.30), room_above - 0.02);
    const double deep = r.uniform(0.7, 0.92) * depth;
    b.box({x + width / 2, deep / 2, floor + height / 2}, {width / 2 - 0.001, deep / 2, height / 2},
          pick(r, p.books));
    x += width;
  }
}

void bookshelf(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  const int wood = r.chance(0.5) ? p.wood_light : p.wood_dark;
  const double height = r.uniform(1.75, 2.15);
  const double depth = 0.28;
  const int levels = 5;
  b.box({0, 0.01, height / 2}, {width / 2, 0.01, height / 2}, wood);
  for (const double side : {-1.0, 1.0}) {
    b.box({side * (width / 2 - 0.01), depth / 2, height / 2}, {0.01, depth / 2, height / 2}, wood);
  }
  for (int i = 0; i <= levels; ++i) {
    const double z = 0.06 + (height - 0.07) * i / levels;
    b.box({0, depth / 2, z}, {width / 2 - 0.02, depth / 2, 0.011}, wood);
    if (i == levels) continue;
    const double above = (height - 0.07) / levels - 0.022;
    if (r.chance(0.8)) {
      bookRow(b, p, -width / 2 + 0.03, width / 2 - 0.03, depth, z + 0.011, above);
    } else {
      b.box({r.uniform(-0.1, 0.1), depth / 2, z + 0.011 + 0.11}, {0.16, depth * 0.42, 0.11},
            pick(r, p.cartons));
    }
  }
}

void cabinet(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  const int body = r.chance(0.4) ? p.white : (r.chance(0.5) ? p.wood_light : p.wood_dark);
  const double height = r.uniform(0.72, 1.15);
  const double depth = r.uniform(0.38, 0.46);
  b.box({0, depth / 2, height / 2}, {width / 2, depth / 2, height / 2}, body);
  const int doors = width > 0.7 ? 2 : 1;
  for (int i = 0; i < doors; ++i) {
    const double w = width / doors;
    const double x = -width / 2 + (i + 0.5) * w;
    b.box({x, depth + 0.008, height / 2}, {w / 2 - 0.008, 0.008, height / 2 - 0.03}, body);
    b.rod({x + w * 0.35, depth + 0.03, height * 0.62}, {x + w * 0.35, depth + 0.03, height * 0.76},
          0.008, p.metal);
  }
  for (double x = -width / 2 + 0.15; x < width / 2 - 0.1; x += r.uniform(0.22, 0.4)) {
    const double z = height;
    switch (r.below(5)) {
      case 0:
        b.box({x, depth / 2, z + 0.11}, {0.13, 0.1, 0.11}, pick(r, p.cartons),
              r.uniform(-0.5, 0.5));
        break;
      case 1:
        b.cylinder({x, depth / 2, z + 0.09}, 0.06, 0.09, b.plain(randomColour(r, 60, 220, 0.7)));
        b.ellipsoid({x, depth / 2, z + 0.32}, {0.13, 0.12, 0.17}, p.leaves);
        break;
      case 2:
        b.box({x, 0.06, z + 0.16}, {0.11, 0.012, 0.16}, pick(r, p.posters));
        break;
      case 3:
        bookRow(b, p, x - 0.1, x + 0.12, depth * 0.7, z, 0.3);
        break;
      default:
        b.cylinder({x, depth * 0.6, z + 0.05}, 0.04, 0.05, b.plain(randomColour(r, 80, 240, 0.8)));
    }
  }
}

void chair(Builder& b, const Palette& p, double x, double y, double yaw) {
  Random& r = b.random();
  const Eigen::Quaterniond q(Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
  const SE3 T_FS(q, Vec3(x, y, 0));
  const int cloth = b.tiling(b.texture(paintCloth(r, 192, 192)), 0.0015F, 0.5F);
  const auto at = [&](const Vec3& c) { return T_FS * c; };
  b.box(at({0, 0, 0.46}), {0.21, 0.21, 0.025}, cloth, yaw);
  b.box(at({0, 0.2, 0.72}), {0.2, 0.02, 0.16}, cloth, yaw);
  for (const double sx : {-1.0, 1.0}) {
    for (const double sy : {-1.0, 1.0}) {
      b.rod(at({0.18 * sx, 0.18 * sy, 0}), at({0.18 * sx, 0.18 * sy, sy > 0 ? 0.58 : 0.44}), 0.014,
            p.metal);
    }
  }
}

void desk(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  const int wood = r.chance(0.5) ? p.wood_light : p.white;
  const double depth = 0.64;
  b.box({0, depth / 2, 0.735}, {width / 2, depth / 2, 0.015}, wood);
  for (const double side : {-1.0, 1.0}) {
    b.box({side * (width / 2 - 0.03), depth / 2, 0.36}, {0.025, depth / 2 - 0.05, 0.36}, p.metal);
  }
  const double x = r.uniform(-0.2, 0.2) * width;
  const Image<Rgb> picture = paintScreen(r, 480, 300);
  const int lit = b.print(picture, 0.10F, 0.15F);
  b.box({x, 0.2, 1.03}, {0.27, 0.02, 0.17}, p.black).material[3] = lit;
  b.box({x, 0.19, 0.80}, {0.03, 0.02, 0.06}, p.black);
  b.box({x, 0.2, 0.756}, {0.12, 0.09, 0.006}, p.black);
  b.box({x, 0.45, 0.76}, {0.22, 0.07, 0.012}, p.black).material[5] =
      b.print(paintKeyboard(r, 440, 140), 0.3F);
  for (int i = 0; i < 3; ++i) {
    b.box({r.uniform(-0.4, 0.4) * width, r.uniform(0.3, 0.55), 0.7515 + 0.001 * i},
          {0.105, 0.148, 0.001}, pick(r, p.pages), r.uniform(-0.6, 0.6));
  }
  b.cylinder({r.uniform(-0.45, -0.3) * width, 0.4, 0.80}, 0.04, 0.05,
             b.plain(randomColour(r, 80, 240, 0.8)));
  bookRow(b, p, 0.27 * width, 0.48 * width, 0.24, 0.75, 0.32);
  chair(b, p, x + r.uniform(-0.2, 0.2), 0.52, std::numbers::pi * r.uniform(-0.15, 0.15));
}

void door(Builder& b, const Palette& p, double) {
  Random& r = b.random();
  const int leaf = r.chance(0.5) ? p.wood_light : p.white;
  b.box({0, 0.02, 1.0}, {0.43, 0.02, 1.0}, leaf);
  for (const double side : {-1.0, 1.0}) {
    b.box({side * 0.47, 0.03, 1.03}, {0.04, 0.03, 1.03}, p.white);
  }
  b.box({0, 0.03, 2.07}, {0.51, 0.03, 0.04}, p.white);
  b.rod({0.3, 0.09, 1.03}, {0.4, 0.09, 1.03}, 0.01, p.metal);
  b.box({0.0, 0.045, 1.5}, {0.105, 0.001, 0.148}, pick(r, p.pages));
}

void window(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  Material glass;
  glass.tint = {0.55F, 0.62F, 0.70F};
  glass.infrared = 0.0F;  // the pattern goes through
  glass.gloss = 0.3F;
  glass.glow = 0.9F;
  b.box({0, 0.01, 1.55}, {width / 2, 0.01, 0.6}, b.material(glass));
  for (int i = 0; i < 3; ++i) {
    b.box({(i - 1) * (width / 2), 0.03, 1.55}, {0.03, 0.03, 0.6}, p.white);
  }
  for (const double z : {0.95, 2.15}) b.box({0, 0.03, z}, {width / 2, 0.03, 0.03}, p.white);
  b.box({0, 0.1, 0.91}, {width / 2 + 0.08, 0.1, 0.015}, p.white);
  for (int i = 0; i < 14; ++i) {  // radiator
    b.box({(i - 6.5) * width / 15, 0.07, 0.48}, {width / 36, 0.05, 0.3}, p.white);
  }
  const int cloth = b.tiling(b.texture(paintCloth(r, 256, 256)), 0.002F, 0.6F);
  for (const double side : {-1.0, 1.0}) {
    for (int fold = 0; fold < 4; ++fold) {
      b.cylinder({side * (width / 2 + 0.02 + 0.055 * fold), 0.13 + 0.02 * (fold % 2), 1.25}, 0.042,
                 1.15, cloth);
    }
  }
}

void wardrobe(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  const int wood = r.chance(0.6) ? p.wood_dark : p.wood_light;
  const double height = r.uniform(1.85, 2.1);
  b.box({0, 0.26, height / 2}, {width / 2, 0.26, height / 2}, wood);
  for (const double side : {-1.0, 1.0}) {
    b.box({side * width / 4, 0.53, height / 2}, {width / 4 - 0.006, 0.012, height / 2 - 0.05},
          wood);
    b.rod({side * 0.05, 0.56, 0.95}, {side * 0.05, 0.56, 1.1}, 0.009, p.metal);
  }
  b.box({width * 0.22, 0.543, 1.45}, {0.148, 0.001, 0.21}, pick(r, p.posters));
  b.box({0, 0.25, height + 0.13}, {0.25, 0.18, 0.13}, pick(r, p.cartons), r.uniform(-0.2, 0.2));
}

void posterWall(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  for (double x = -width / 2 + 0.3; x < width / 2 - 0.2; x += r.uniform(0.62, 0.8)) {
    const double scale = r.uniform(0.8, 1.25);
    b.box({x, 0.003, r.uniform(1.25, 1.6)}, {0.24 * scale, 0.003, 0.34 * scale},
          pick(r, p.posters));
  }
  for (int i = 0; i < 2; ++i) {
    b.box({r.uniform(-0.4, 0.4) * width, 0.25, 0.17}, {0.24, 0.19, 0.17}, pick(r, p.cartons),
          r.uniform(-0.3, 0.3));
  }
  if (r.chance(0.7)) {  // a bin or a plant on the floor
    const double x = r.uniform(-0.4, 0.4) * width;
    b.cylinder({x, 0.35, 0.17}, 0.14, 0.17, b.plain(randomColour(r, 40, 200, 0.5)));
    if (r.chance(0.6)) {
      for (int i = 0; i < 5; ++i) {
        b.ellipsoid(
            {x + r.uniform(-0.12, 0.12), 0.35 + r.uniform(-0.1, 0.12), r.uniform(0.5, 1.15)},
            {0.16, 0.13, 0.17}, p.leaves, r.uniform(0, 3));
      }
    }
  }
}

void whiteboard(Builder& b, const Palette& p, double width) {
  Random& r = b.random();
  const double w = std::min(width, 1.5) / 2 - 0.05;
  b.box({0, 0.015, 1.45}, {w, 0.015, 0.45}, p.metal).material[3] =
      b.print(paintWhiteboard(r, 700, 440), 0.7F, 0.15F);
  b.box({0, 0.05, 1.0}, {w, 0.05, 0.008}, p.metal);
  cabinet(b, p, std::min(width, 1.2));
}

struct Kind {
  Thing make;
  double width;
};

constexpr double kCorner = 0.62;  // left free at a wall's start, where the last wall's things reach

/// Small flat things that a free wall collects: sockets, switches, notes, a clock, a cable duct.
void wallClutter(Builder& b, const Palette& p, double left, double right) {
  Random& r = b.random();
  for (double x = left + r.uniform(0.1, 0.4); x < right - 0.15; x += r.uniform(0.4, 0.8)) {
    switch (r.below(6)) {
      case 0:
        b.box({x, 0.006, r.chance(0.5) ? 0.3 : 1.1}, {0.04, 0.006, 0.04}, p.white);
        break;
      case 1:
        b.box({x, 0.002, r.uniform(1.2, 1.75)}, {0.105, 0.001, 0.148}, pick(r, p.pages));
        break;
      case 2:
        b.rod({x, 0.0, 2.0}, {x, 0.03, 2.0}, 0.14, p.white);
        b.rod({x, 0.0, 2.0}, {x, 0.035, 2.0}, 0.012, p.black);
        b.box({x + 0.03, 0.034, 2.03}, {0.04, 0.002, 0.006}, p.black);
        break;
      case 3: {
        const double size = r.uniform(0.1, 0.2);
        b.box({x, 0.01, r.uniform(1.35, 1.7)}, {size * 1.3 + 0.02, 0.01, size + 0.02}, p.wood_dark)
            .material[3] = pick(r, p.posters);
        break;
      }
      case 4:
        b.box({x, 0.012, 1.3}, {0.02, 0.012, 1.3}, p.white);
        break;
      default:
        b.box({x, 0.09, 1.62}, {0.3, 0.09, 0.012}, p.wood_light);
        bookRow(b, p, x - 0.27, x + 0.2, 0.17, 1.632, 0.3);
    }
  }
}

/// Fills one wall with things, left to right; frame as of Thing.
void furnish(Builder& b, const Palette& p, const SE3& T_WF, double length, int most_windows,
             Random& order) {
  static const std::array<Kind, 8> kKinds = {{{bookshelf, 0.9},
                                              {cabinet, 1.0},
                                              {desk, 1.45},
                                              {door, 1.1},
                                              {window, 1.5},
                                              {wardrobe, 1.0},
                                              {posterWall, 1.5},
                                              {whiteboard, 1.5}}};
  constexpr int kWindow = 4;
  int windows = 0;
  int last = -1;
  double x = kCorner;
  while (length - x > 0.95) {
    int k = order.below(static_cast<int>(kKinds.size()));
    windows += k == kWindow ? 1 : 0;
    if (k == last || (k == kWindow && windows > most_windows) ||
        kKinds[static_cast<std::size_t>(k)].width > length - x) {
      k = length - x < 1.1 || last == 1 ? 0 : 1;
    }
    const Kind& kind = kKinds[static_cast<std::size_t>(k)];
    const double width = std::min(kind.width, length - x) * order.uniform(0.94, 1.0);
    b.place(0, T_WF * SE3(Eigen::Quaterniond::Identity(), Vec3(x + width / 2, 0, 0)));
    kind.make(b, p, width - 0.06);
    if ((k == 1 || k == 2) && order.chance(0.85)) {  // something on the wall above
      b.box({order.uniform(-0.1, 0.1), 0.003, order.uniform(1.6, 1.8)}, {0.22, 0.003, 0.31},
            pick(order, p.posters));
    }
    if (k == 1 || k == 2 || k == 6) wallClutter(b, p, -width / 2, width / 2);
    x += width;
    last = k;
  }
}

void shell(Builder& b, const Palette& p, const RoomSize& s) {
  Random& r = b.random();
  const double thick = 0.1;
  const int floor = b.tiling(b.texture(paintFloor(r, 1024, 1024)), 0.002F, 0.5F, 0.08F);
  const int ceiling = b.plain({240, 240, 236}, 0.75F);
  b.box({0, 0, -thick}, {s.half_x + 0.2, s.half_y + 0.2, thick}, floor);
  b.box({0, 0, s.height + thick}, {s.half_x + 0.2, s.half_y + 0.2, thick}, ceiling);
  const int accent_wall = r.below(4);  // painted in another colour
  const int accent_paint =
      b.tiling(b.texture(paintPlaster(r, 512, 512, randomColour(r, 140, 225, 0.3))), 0.003F, 0.7F);
  for (int i = 0; i < 4; ++i) {
    const double sign = i % 2 == 0 ? -1.0 : 1.0;
    const int paint = i == accent_wall ? accent_paint : p.plaster;
    const bool along_y = i < 2;
    const Vec3 centre = along_y ? Vec3(sign * (s.half_x + thick), 0, s.height / 2)
                                : Vec3(0, sign * (s.half_y + thick), s.height / 2);
    const Vec3 half = along_y ? Vec3(thick, s.half_y + 2 * thick, s.height / 2)
                              : Vec3(s.half_x + 2 * thick, thick, s.height / 2);
    b.box(centre, half, paint);
    const Vec3 inward = along_y ? Vec3(-sign, 0, 0) : Vec3(0, -sign, 0);
    Vec3 strip = half;
    (along_y ? strip.x() : strip.y()) = 0.008;
    strip.z() = 0.04;
    Vec3 at = centre + (thick + 0.008) * inward;
    at.z() = 0.04;
    b.box(at, strip, p.white);
  }
}

void lamps(World& world, Builder& b, const RoomSize& s) {
  Material tube;
  tube.glow = 3.0F;
  tube.infrared = 0.3F;
  const int glow = b.material(tube);
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      Lamp lamp;
      lamp.centre_W = {x * s.half_x, y * s.half_y, s.height - 0.03};
      lamp.half = {0.6, 0.15, 0};
      const auto warm = static_cast<float>(b.random().uniform(0.9, 1.0));
      lamp.power = Eigen::Vector3f(1.0F, 0.5F + 0.5F * warm, warm) *
                   static_cast<float>(b.random().uniform(0.45, 1.5));
      world.lamps.push_back(lamp);
      b.box(lamp.centre_W + Vec3(0, 0, 0.015), {0.6, 0.15, 0.02}, glow);
    }
  }
}

}  // namespace

void buildRoom(World& world, const RoomSize& size, std::uint64_t seed) {
  Builder b(world, seed, 0x2003);
  const Palette palette = paintPalette(b);
  b.place(0, SE3());
  shell(b, palette, size);
  lamps(world, b, size);
  Random order(seed, 0x0DE2);
  const std::array<Vec3, 4> corners = {
      Vec3(size.half_x, size.half_y, 0), Vec3(-size.half_x, size.half_y, 0),
      Vec3(-size.half_x, -size.half_y, 0), Vec3(size.half_x, -size.half_y, 0)};
  // Counter-clockwise from the corner +x +y; x of a wall runs along it, y out of it.
  const std::array<double, 4> lengths = {2 * size.half_x, 2 * size.half_y, 2 * size.half_x,
                                         2 * size.half_y};
  for (std::size_t i = 0; i < 4; ++i) {
    const double yaw = std::numbers::pi * (1.0 + 0.5 * static_cast<double>(i));
    const Eigen::Quaterniond q(Eigen::AngleAxisd(yaw, Vec3::UnitZ()));
    // No window (which has no depth) in the wall that most scenes look at.
    furnish(b, palette, SE3(q, corners[i]), lengths[i], i == 3 ? 0 : 1, order);
  }
}

}  // namespace rf::sim
