// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/surfel_fusion.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "geometry/pyramid.hpp"
#include "mapping/body_model.hpp"

namespace rf {
namespace {

// A still camera at the world's origin that fuses what it is shown into one model.
class Mapper {
 public:
  explicit Mapper(const Camera& camera = test::testCamera())
      : full_(camera), body_(config, camera.reduced(2)) {}

  void show(const test::Scene& scene, double noise, bool dynamic_is_object = false) {
    const test::Shot shot = test::shoot(scene, SE3(), full_, {noise, 0, 9}, time_);
    const RgbdLevel level = reduceFrame(shot.frame.colour, shot.frame.depth_mm, full_, 2, 0.3, 6.0);
    const FrameMaps maps =
        makeFrameMaps(level.camera, level.depth, reduceColour(shot.frame.colour, 2), config.sensor);
    Image<std::uint8_t> score(level.camera.width, level.camera.height, 255);
    for (int v = 0; v < score.height() && dynamic_is_object; ++v) {
      for (int u = 0; u < score.width(); ++u)
        score(u, v) = shot.dynamic(2 * u, 2 * v) != 0 ? 0 : 255;
    }
    const SplitWeights w = splitWeights(score, maps.depth);
    ++time_;
    body_.predictor.predict(body_.map, SE3(), level.camera, PredictOptions::from(config),
                            body_.prediction);
    const Image<std::uint8_t> none;
    const FuseStats stats =
        fuseFrame({maps, w.world, w.object.interior, none, SE3(), time_, time_ == 1}, config,
                  body_.map, body_.prediction);
    body_.cleaner.noteGrowth(stats.grown, time_);
    body_.cleaner.clean(maps, SE3(), time_, config, body_.prediction.blocks, body_.map);
  }

  // Root mean square distance to the plane z = depth, and count, of surfels with z in [low, high].
  double rms(double depth, double low, double high, int* count = nullptr) const {
    double sum = 0;
    int n = 0;
    for (int b = 0; b < body_.map.blocks(); ++b) {
      for (int i = 0; i < body_.map.block(b).count; ++i) {
        const Surfel s = body_.map.block(b).get(i);
        if (s.point.z() < low || s.point.z() > high) continue;
        sum += (s.point.z() - depth) * (s.point.z() - depth);
        ++n;
      }
    }
    if (count != nullptr) *count = n;
    return n > 0 ? std::sqrt(sum / n) : 0.0;
  }

  // Exported points with z in [low, high].
  int exported(double low, double high) const {
    int n = 0;
    for (const SurfelPoint& p : exportSurfels(body_, SE3(), config.surfels))
      n += p.z >= low && p.z <= high ? 1 : 0;
    return n;
  }

  const SurfelMap& map() const { return body_.map; }
  FusionConfig config;

 private:
  Camera full_;
  BodyModel body_;
  int time_ = 0;
};

test::SceneBox wallAt(double z) {
  return {SE3(Mat3::Identity(), Vec3(0, 0, z + 0.5)), Vec3(9, 9, 0.5), false, 0, false};
}

TEST(SurfelFusion, AveragesNoiseDownWithTheNumberOfFrames) {
  const test::Scene scene{{wallAt(2.0)}};
  Mapper mapper;
  mapper.show(scene, 1.0);
  const double one = mapper.rms(2.0, 1.8, 2.2);
  const std::int64_t first = mapper.map().size();
  constexpr int kFrames = 25;
  for (int i = 1; i < kFrames; ++i) mapper.show(scene, 1.0);
  const double many = mapper.rms(2.0, 1.8, 2.2);
  EXPECT_GT(one, 0.001);
  // Ideal is 1 / sqrt(25) = 0.2; whole millimetres and weights leave a little more.
  EXPECT_LT(many, 0.32 * one);
  EXPECT_LT(mapper.map().size(), first + first / 20) << "a known wall must not grow";
}

TEST(SurfelFusion, RemovesABoxThatIsGoneAndKeepsTheWall) {
  const test::SceneBox box{SE3(Mat3::Identity(), Vec3(0, 0, 1.4)), Vec3(0.25, 0.25, 0.1), false, 1,
                           false};
  Mapper mapper;
  for (int i = 0; i < 12; ++i) mapper.show({{wallAt(2.0), box}}, 0.5);
  int on_box = 0, on_wall = 0;
  mapper.rms(1.3, 1.2, 1.4, &on_box);
  mapper.rms(2.0, 1.9, 2.1, &on_wall);
  EXPECT_GT(on_box, 500);
  for (int i = 0; i < 12; ++i) mapper.show({{wallAt(2.0)}}, 0.5);
  int box_left = 0, wall_now = 0;
  mapper.rms(1.3, 1.2, 1.7, &box_left);
  mapper.rms(2.0, 1.9, 2.1, &wall_now);
  EXPECT_LE(box_left, on_box / 100);
  EXPECT_GT(wall_now, on_wall) << "the wall behind it is filled in";
}

TEST(SurfelFusion, LosesSurfelsThatTurnOutToBelongToTheOtherBody) {
  const test::SceneBox box =
      test::movingBox(SE3(Mat3::Identity(), Vec3(0, 0, 1.4)), Vec3(0.3, 0.3, 0.1));
  Mapper mapper;
  for (int i = 0; i < 12; ++i) mapper.show({{wallAt(2.0), box}}, 0.5);
  int before = 0, after = 0;
  mapper.rms(1.3, 1.2, 1.4, &before);
  for (int i = 0; i < 12; ++i) mapper.show({{wallAt(2.0), box}}, 0.5, true);
  mapper.rms(1.3, 1.2, 1.4, &after);
  EXPECT_GT(before, 500);
  EXPECT_LT(after, before / 4) << "only the mask's border may remain";
}

TEST(SurfelFusion, IgnoresDepthThatIsNotANumber) {
  FusionConfig config;
  Image<float> depth(16, 16, 1.0F);
  depth(3, 3) = std::numeric_limits<float>::quiet_NaN();
  depth(4, 4) = std::numeric_limits<float>::infinity();
  depth(5, 5) = -1.0F;
  limitDepth(config.sensor, depth);
  EXPECT_EQ(depth(3, 3), 0.0F);
  EXPECT_EQ(depth(4, 4), 0.0F);
  EXPECT_EQ(depth(5, 5), 0.0F);
  EXPECT_EQ(depth(6, 6), 1.0F);
}

TEST(FrameMaps, GivesTheNormalOfATiltedPlane) {
  const Camera camera = test::testCamera(64, 48);
  const Vec3 n = Vec3(0.3, -0.2, -1.0).normalized();
  Image<float> depth(64, 48);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u)
      depth(u, v) = static_cast<float>(-1.5 / n.dot(camera.backProject(u, v, 1.0)));
  }
  const FrameMaps maps = makeFrameMaps(camera, depth, Image<Rgb>(64, 48), SensorConfig{});
  for (int v = 5; v < 43; ++v) {
    for (int u = 5; u < 59; ++u) {
      const Vec3 got(maps.nx(u, v), maps.ny(u, v), maps.nz(u, v));
      ASSERT_GT(got.dot(n), 0.999) << u << " " << v;
    }
  }
}

TEST(FrameMaps, WeighsPixelsNearTheMaskBorderDown) {
  Image<std::uint8_t> score(20, 20, 255);
  for (int v = 0; v < 20; ++v) {
    for (int u = 10; u < 20; ++u) score(u, v) = 0;
  }
  const SplitWeights w = splitWeights(score, Image<float>(20, 20, 1.0F));
  EXPECT_FLOAT_EQ(w.world.own(4, 10), 1.0F);
  EXPECT_LT(w.world.own(9, 10), 0.7F);
  EXPECT_FLOAT_EQ(w.world.own(10, 10), 0.0F);
  EXPECT_FLOAT_EQ(w.object.own(15, 10), 1.0F);
  EXPECT_EQ(w.world.interior(8, 10), 1);
  EXPECT_EQ(w.world.interior(9, 10), 0);
  EXPECT_EQ(w.object.interior(10, 10), 0);
  EXPECT_EQ(w.object.interior(11, 10), 1);
}

TEST(SurfelFusion, WhatIsLeftOfAThingThatHasGoneIsNotExported) {
  const auto box = [](double y, double height) {
    return test::SceneBox{SE3(Mat3::Identity(), Vec3(0, y, 1.5)), Vec3(0.2, 0.5 * height, 0.05),
                          false, 0, false};
  };
  const test::Scene seated{{wallAt(2.0), box(-0.2, 0.4), box(0.05, 0.1)}};
  const test::Scene risen{{wallAt(2.0), box(0.05, 0.1)}};
  Mapper mapper;
  for (int i = 0; i < 10; ++i) mapper.show(seated, 0);
  const int all = mapper.exported(1.4, 1.6);
  EXPECT_GT(all, 1000);
  for (int i = 0; i < 12; ++i) mapper.show(risen, 0);
  EXPECT_EQ(mapper.exported(1.4, 1.6), 0) << "most of it has gone";
  EXPECT_GT(mapper.exported(1.9, 2.1), 1000) << "the wall has not";
  mapper.config.surfels.export_remnants = true;
  EXPECT_GT(mapper.exported(1.4, 1.6), all / 10);
  mapper.config.surfels.export_remnants = false;
  for (int i = 0; i < 40; ++i) mapper.show(risen, 0);
  EXPECT_GT(mapper.exported(1.4, 1.6), all / 10) << "it stands by itself";
}

}  // namespace
}  // namespace rf
