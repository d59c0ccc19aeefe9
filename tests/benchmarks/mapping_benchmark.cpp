// SPDX-License-Identifier: BSD-3-Clause
// Kernels of fusion at 320x240 on one view of an analytic room, with sensor noise.
#include <benchmark/benchmark.h>

#include <stdexcept>

#include "../mapping/analytic_scene.hpp"
#include "geometry/pyramid.hpp"
#include "mapping/body_model.hpp"
#include "mapping/tracker.hpp"

namespace rf {
namespace {

struct Fixture {
  FusionConfig config;
  Camera full = test::testCamera(640, 480);
  test::Shot shot =
      test::shoot(test::room(), SE3(Mat3::Identity(), Vec3(0, 0, -1.2)), full, {1.0, 3.0, 1}, 0);
  RgbdLevel level = reduceFrame(shot.frame.colour, shot.frame.depth_mm, full, 2, 0.3, 5.0);
  FrameMaps maps =
      makeFrameMaps(level.camera, level.depth, reduceColour(shot.frame.colour, 2), config.sensor);
  SplitWeights weights = splitWeights(Image<std::uint8_t>(320, 240, 255), maps.depth);
  Image<std::uint8_t> none;
  BodyModel body{config, level.camera};

  Fixture() {
    fuseFrame(input(1), config, body.map, body.prediction);
    for (int t = 2; t < 8; ++t) {
      predict();
      fuseFrame(input(t), config, body.map, body.prediction);
    }
    predict();
  }
  FuseInput input(int time) const {
    return {maps, weights.world, weights.object.interior, none, SE3(), time, time == 1};
  }
  void predict() {
    body.predictor.predict(body.map, SE3(), level.camera, PredictOptions::from(config),
                           body.prediction);
  }
};

void prepare(benchmark::State& state) {
  const Fixture f;
  for (auto _ : state) {
    const RgbdLevel level =
        reduceFrame(f.shot.frame.colour, f.shot.frame.depth_mm, f.full, 2, 0.3, 5.0);
    benchmark::DoNotOptimize(makeFrameMaps(level.camera, level.depth,
                                           reduceColour(f.shot.frame.colour, 2), f.config.sensor));
    benchmark::DoNotOptimize(buildPyramid(level, 3));
    benchmark::DoNotOptimize(splitWeights(Image<std::uint8_t>(320, 240, 255), f.maps.depth));
  }
}

void predict(benchmark::State& state) {
  Fixture f;
  for (auto _ : state) f.predict();
  state.counters["surfels"] = static_cast<double>(f.body.map.size());
}

void fuse(benchmark::State& state) {
  Fixture f;
  int time = 10;
  FuseStats stats;
  for (auto _ : state) stats = fuseFrame(f.input(time++), f.config, f.body.map, f.body.prediction);
  if (stats.matched < 60000) throw std::runtime_error("fuse: too few matches");
}

void clean(benchmark::State& state) {
  Fixture f;
  int time = 10;
  for (auto _ : state) {
    f.body.cleaner.clean(f.maps, SE3(), time++, f.config, f.body.prediction.blocks, f.body.map);
  }
}

void reference(benchmark::State& state) {
  const Fixture f;
  for (auto _ : state) benchmark::DoNotOptimize(makeReference(f.body.prediction, 3, -1.1F));
}

void rows(benchmark::State& state) {
  const Fixture f;
  const std::vector<TrackReference> ref = makeReference(f.body.prediction, 3, -1.1F);
  const TrackLevel level{f.level.camera, f.level.depth, f.level.intensity};
  const KernelInput in = kernelInput(level, f.weights.world.own, SE3(), f.config);
  for (auto _ : state) {
    KernelSums sums;
    accumulateRows(ref[0].points, 0, ref[0].points.size(), in, sums);
    benchmark::DoNotOptimize(sums);
  }
}

void align(benchmark::State& state) {
  const Fixture f;
  std::vector<TrackLevel> frame;
  for (const RgbdLevel& l : buildPyramid(f.level, 3))
    frame.push_back({l.camera, l.depth, l.intensity});
  const std::vector<TrackReference> ref = makeReference(f.body.prediction, 3, -1.1F);
  const WeightPyramid w = weightPyramid(f.weights.world.own, 3);
  Vec6 off;
  off << 0.003, -0.002, 0.004, 0.008, -0.009, 0.005;
  int iterations = 0;
  for (auto _ : state) {
    const TrackResult r =
        alignToModel(ref, frame, w, SE3::exp(off), Mat6::Identity() * 1e-3, 500, f.config);
    if (!r.accepted) throw std::runtime_error("align: " + r.reason);
    iterations = r.iterations;
  }
  state.counters["iterations"] = iterations;
}

BENCHMARK(prepare)->Unit(benchmark::kMillisecond);
BENCHMARK(predict)->Unit(benchmark::kMillisecond);
BENCHMARK(fuse)->Unit(benchmark::kMillisecond);
BENCHMARK(clean)->Unit(benchmark::kMillisecond);
BENCHMARK(reference)->Unit(benchmark::kMillisecond);
BENCHMARK(rows)->Unit(benchmark::kMillisecond);
BENCHMARK(align)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rf

BENCHMARK_MAIN();
