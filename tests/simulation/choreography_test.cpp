// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "simulation/depth_sensor.hpp"
#include "simulation/raycaster.hpp"
#include "simulation/world.hpp"

namespace rf::sim {
namespace {

/// What a scene does, from rays at an eighth of the resolution.
struct SceneFacts {
  double camera_path = 0, camera_peak = 0, object_path = 0, object_peak = 0;
  double share_peak = 0, share_mean = 0, onset = -1;
  double nearest_static = 1e9;
  int static_deepest = 0;  ///< frames in which less than half of the pixels have depth
  double level_error = 0;  ///< how far the camera leaves its plane, metres
};

SceneFacts look(const std::string& scene, std::uint64_t seed) {
  World world = buildWorld(scene, seed);
  world.camera = world.camera.reduced(8);
  SceneFacts f;
  double sum = 0;
  const SE3 first = world.camera_at(0);
  for (int k = 0; k < world.frames; ++k) {
    const double t = k / kFrameRate;
    const double before = (k - 1) / kFrameRate;
    const SE3 T_WC = world.camera_at(t);
    const double step = (T_WC.t - world.camera_at(before).t).norm();
    f.camera_path += step;
    f.camera_peak = std::max(f.camera_peak, step * kFrameRate);
    f.level_error = std::max(f.level_error, std::abs(T_WC.t.z() - first.t.z()));
    if (!world.body_at.empty()) {
      const double moved = (world.body_at[0](t).t - world.body_at[0](before).t).norm();
      f.object_path += moved;
      f.object_peak = std::max(f.object_peak, moved * kFrameRate);
      if (f.onset < 0 && moved * kFrameRate > 0.03) f.onset = t;
    }
    if (k % 10 != 0) continue;
    const SurfaceImage s = Raycaster(world, bodyPoses(world, t), T_WC).castAll();
    double valid = 0;
    double object = 0;
    const auto columns = static_cast<std::size_t>(s.z.width());
    for (std::size_t i = 0; i < s.z.size(); ++i) {
      // The sensor's borders have no depth: 10 and 26 columns, 6 and 11 rows of 640 x 480.
      const std::size_t u = i % columns;
      const std::size_t v = i / columns;
      if (u < 1 || u > 76 || v < 1 || v > 58) continue;
      const int body =
          s.primitive[i] < 0 ? 0 : world.primitives[static_cast<std::size_t>(s.primitive[i])].body;
      if (body == 0 && s.z[i] > 0) f.nearest_static = std::min<double>(f.nearest_static, s.z[i]);
      if (s.z[i] < 0.4F || s.z[i] > 5.0F) continue;
      valid += 1;
      object += body > 0 ? 1 : 0;
    }
    if (valid < 0.5 * static_cast<double>(s.z.size())) ++f.static_deepest;
    f.share_peak = std::max(f.share_peak, object / std::max(1.0, valid));
    sum += object / std::max(1.0, valid);
  }
  f.share_mean = sum / ((world.frames + 9) / 10);
  return f;
}

void print(const std::string& scene, std::uint64_t seed, const SceneFacts& f) {
  std::printf(
      "%-12s seed %llu camera %.2f m peak %.2f m/s | object %.2f m peak %.2f m/s onset %.2f s | "
      "share peak %.2f mean %.2f | nearest static %.2f m | poor frames %d\n",
      scene.c_str(), static_cast<unsigned long long>(seed), f.camera_path, f.camera_peak,
      f.object_path, f.object_peak, f.onset, f.share_peak, f.share_mean, f.nearest_static,
      f.static_deepest);
}

class PaperScene : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(PaperScene, MovesAsThePaperSays) {
  const auto [scene, share] = GetParam();
  for (const std::uint64_t seed : {1U}) {
    const SceneFacts f = look(scene, seed);
    print(scene, seed, f);
    EXPECT_GE(f.camera_path, 2.0);
    EXPECT_GE(f.camera_peak, 0.15);
    EXPECT_LE(f.camera_peak, 0.55);
    EXPECT_GE(f.object_peak, 0.15);
    EXPECT_LE(f.object_peak, 0.55);
    EXPECT_GE(f.onset, 1.0);
    EXPECT_LE(f.onset, 2.0);
    EXPECT_NEAR(f.share_peak, share, 0.05);
    EXPECT_GT(f.nearest_static, 0.4);
    EXPECT_EQ(f.static_deepest, 0);
    EXPECT_LT(f.level_error, 1e-9) << "plane-parallel motion";
    const World world = buildWorld(scene, seed);
    EXPECT_EQ(world.body_at[0](0.0), world.body_at[0](0.95)) << "rests for the first second";
  }
}

INSTANTIATE_TEST_SUITE_P(Choreography, PaperScene,
                         testing::Values(std::pair{"straight", 0.35}, std::pair{"orbit", 0.30},
                                         std::pair{"overtake", 0.55}, std::pair{"sideway", 0.55}),
                         [](const auto& param) { return std::string(param.param.first); });

/// Share of the moving bodies in what the depth sensor gives at full resolution.
double sensedShare(const World& world, double t) {
  const SurfaceImage s = Raycaster(world, bodyPoses(world, t), world.camera_at(t)).castAll();
  DepthInput in{s.z, Image<float>(s.z.width(), s.z.height(), 1.0F),
                Image<float>(s.z.width(), s.z.height(), 0.6F),
                Image<std::uint8_t>(s.z.width(), s.z.height())};
  for (std::size_t i = 0; i < s.z.size(); ++i) {
    if (s.primitive[i] < 0) continue;
    in.body[i] =
        static_cast<std::uint8_t>(world.primitives[static_cast<std::size_t>(s.primitive[i])].body);
  }
  double valid = 0;
  double moving = 0;
  for (const std::uint8_t label : senseDepth(in, world.camera, 1).mask) {
    valid += label > 0 ? 1 : 0;
    moving += label == 2 ? 1 : 0;
  }
  return moving / std::max(1.0, valid);
}

TEST(Choreography, SizeSweepHasItsShare) {
  for (const int percent : {14, 30, 43, 50, 65, 72, 75, 80, 85}) {
    const World world = buildWorld("size0" + std::to_string(percent), 3);
    double mean = 0;
    for (int k = 0; k < 6; ++k) mean += sensedShare(world, 0.5 + k) / 6;
    std::printf("size0%d: mean share %.3f\n", percent, mean);
    EXPECT_NEAR(mean, percent / 100.0, 0.03);
    const SE3 before = world.body_at[0](0.9);
    EXPECT_EQ(world.body_at[0](0.0), before) << "rests for the first second";
  }
}

TEST(Choreography, OtherScenes) {
  for (const char* scene : {"held", "two_objects", "loop"}) print(scene, 1, look(scene, 1));
  const SceneFacts held = look("held", 1);
  EXPECT_NEAR(held.camera_path, 0.0, 1e-12);
  EXPECT_GT(held.share_peak, 0.12);
  const World loop = buildWorld("loop", 1);
  const SE3 gap = loop.camera_at(0).inverse() * loop.camera_at(loop.frames / kFrameRate);
  EXPECT_LT(gap.log().norm(), 1e-6) << "closes where it began";
  EXPECT_EQ(loop.bodies, 1);
}

/// Seconds of the longest time without a single sensed pixel of the moving body, and when it began.
struct Absence {
  double seconds = 0, begin = 0;
};

Absence longestAbsence(const World& world) {
  constexpr int kEvery = 3;
  Absence longest;
  int hidden = 0;
  for (int k = 0; k < world.frames; k += kEvery) {
    hidden = sensedShare(world, k / kFrameRate) > 0 ? 0 : hidden + kEvery;
    if (hidden / kFrameRate > longest.seconds) {
      longest = {hidden / kFrameRate, (k + kEvery - hidden) / kFrameRate};
    }
  }
  return longest;
}

TEST(Choreography, ObjectLeavesTheViewAndPassesBehindAScreen) {
  for (const char* scene : {"leave", "behind"}) {
    World world = buildWorld(scene, 1);
    print(scene, 1, look(scene, 1));
    EXPECT_GT(sensedShare(world, 0.0), 0.08) << scene;
    EXPECT_GT(sensedShare(world, world.frames / kFrameRate), 0.08) << scene << " comes back";
    world.camera = world.camera.reduced(4);
    const Absence gone = longestAbsence(world);
    std::printf("%s: gone for %.2f s from %.2f s on\n", scene, gone.seconds, gone.begin);
    const bool leaves = std::string(scene) == "leave";
    EXPECT_GT(gone.seconds, leaves ? 1.5 : 0.7) << scene;
    EXPECT_LT(gone.seconds, leaves ? 5.0 : 1.6) << scene;
    const double middle = gone.begin + 0.5 * gone.seconds;
    const double step = 1.0 / kFrameRate;
    EXPECT_GT((world.body_at[0](middle + step).t - world.body_at[0](middle).t).norm(), 0.1 * step)
        << scene << ": it moves while it is hidden";
  }
}

TEST(Choreography, UnknownSceneNamesTheKnown) {
  try {
    buildWorld("nowhere", 1);
    FAIL() << "no error";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("nowhere"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("sideway"), std::string::npos);
  }
}

}  // namespace
}  // namespace rf::sim
