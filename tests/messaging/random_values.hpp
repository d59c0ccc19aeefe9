// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "messaging/conversions.hpp"

namespace rf {

/// Random but valid values of everything that travels, for round trips.
class RandomValues {
 public:
  explicit RandomValues(std::uint64_t seed) : random_(seed) {}

  std::int64_t integer(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double real(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1p-53;
  }
  bool coin() { return (random_() & 1U) != 0; }

  SE3 transform() {
    Vec6 xi;
    for (int i = 0; i < 6; ++i) xi[i] = real(-2, 2);
    return SE3::exp(xi);
  }
  Mat6 covariance() {
    Mat6 a;
    for (int i = 0; i < 36; ++i) a(i / 6, i % 6) = real(-1e-3, 1e-3);
    return a * a.transpose();
  }
  template <class T>
  Image<T> plane(int width, int height, std::int64_t high) {
    Image<T> image(width, height);
    for (T& p : image) p = static_cast<T>(integer(0, high));
    return image;
  }
  StageTimes stages() { return {{"pyramid", real(0, 9)}, {"solve", real(0, 90)}, {"", 0.0}}; }
  Health health() { return static_cast<Health>(integer(1, 4)); }

  BodyMotion motion() { return {transform(), covariance(), health(), real(0, 1e5), real(0, 3)}; }
  BodyPose pose() { return {transform(), covariance(), health(), real(0, 1e5), real(0, 1)}; }

  SegmentationResult segmentation() {
    SegmentationResult s;
    s.utime = integer(0, 1LL << 50);
    s.utime_a = s.utime - integer(0, 1000000);
    s.seq = integer(0, 1000000);
    s.reduction = static_cast<int>(integer(1, 4));
    s.first = coin();
    s.object_moving = coin();
    s.turned = coin();
    s.world_told = coin();
    const int clusters = static_cast<int>(integer(1, 24));
    for (int i = 0; i < clusters; ++i) s.gamma.push_back(static_cast<float>(real(0, 1)));
    const int w = static_cast<int>(integer(1, 90));
    const int h = static_cast<int>(integer(1, 70));
    s.label = plane<std::uint8_t>(w, h, clusters - 1);
    s.label[0] = kNoCluster;
    s.label[s.label.size() - 1] = kSelfLabel;
    s.score = plane<std::uint8_t>(w, h, 255);
    s.camera = motion();
    s.object = motion();
    s.dynamic_share = real(0, 1);
    s.self_share = real(0, 1);
    s.self_behind = real(0, 1);
    s.hypothesis = "camera-first";
    s.has_prior_T_WC = coin();
    if (s.has_prior_T_WC) s.prior_T_WC = transform();
    s.has_T_CO = coin();
    if (s.has_T_CO) s.T_CO = transform();
    s.stage_ms = stages();
    return s;
  }
  ModelState modelState() {
    ModelState s;
    s.utime = integer(0, 1LL << 50);
    s.seq = integer(0, 1000000);
    s.camera = pose();
    s.object_exists = coin();
    s.object_resting = coin();
    s.object = pose();
    s.static_surfels = integer(0, 1000000);
    s.object_surfels = integer(0, 1000000);
    const int w = static_cast<int>(integer(1, 90));
    const int h = static_cast<int>(integer(1, 70));
    s.predicted_depth_mm = plane<std::uint16_t>(w, h, 5000);
    s.body = plane<std::uint8_t>(w, h, 2);
    s.stage_ms = stages();
    return s;
  }
  MotionPrior prior() {
    MotionPrior p;
    p.utime_b = integer(1000000, 1LL << 50);
    p.utime_a = p.utime_b - integer(0, 1000000);
    p.seq = integer(0, 1000000);
    p.camera = static_cast<PriorState>(integer(0, 2));
    p.T_CaCb = transform();
    p.camera_cov = covariance();
    p.T_WCb = transform();
    p.object_kind = static_cast<ObjectPriorKind>(integer(0, 2));
    p.object = static_cast<PriorState>(integer(0, 2));
    p.T_XOa = transform();
    p.T_XOb = transform();
    p.object_cov = covariance();
    for (std::int64_t n = integer(0, 5); n > 0; --n) {
      p.self.push_back({static_cast<RobotShapeKind>(integer(0, 2)),
                        Vec3(real(0.01, 1), real(0.01, 1), real(0.01, 1)), transform()});
    }
    return p;
  }
  EncodedFrame frame() {
    EncodedFrame f;
    f.utime = integer(0, 1LL << 50);
    f.colour_utime = f.utime - integer(0, 20000);
    f.seq = integer(0, 1000000);
    f.width = 64;
    f.height = 48;
    f.colour_format = static_cast<ColourFormat>(integer(0, 2));
    f.depth_zipped = coin();
    for (auto* bytes : {&f.colour, &f.depth}) {
      bytes->resize(static_cast<std::size_t>(integer(0, 3000)));
      for (auto& b : *bytes) b = static_cast<std::uint8_t>(random_());
    }
    return f;
  }
  CameraInfo camera() {
    CameraInfo c{integer(0, 1LL << 50), "test", {640, 480, 535.4, 539.2, 320.1, 247.6}};
    c.camera.distortion = {real(-0.1, 0.1), real(-0.1, 0.1), real(-0.01, 0.01), real(-0.01, 0.01),
                           0};
    return c;
  }
  FrameTick tick() {
    return {integer(0, 1LL << 50), integer(0, 1LL << 50), integer(0, 1000000),
            static_cast<TickState>(integer(1, 3)), coin() ? "" : "unreadable"};
  }
  ModelChunk chunk() {
    ModelChunk c;
    c.utime = integer(0, 1LL << 50);
    c.request_id = integer(-5, 5);
    c.body = coin() ? kBodyStatic : kBodyObject;
    c.n_chunks = static_cast<int>(integer(1, 9));
    c.chunk = static_cast<int>(integer(0, c.n_chunks - 1));
    const auto r = [&] { return static_cast<float>(real(-1, 1)); };
    const auto b = [&] { return static_cast<std::uint8_t>(integer(0, 255)); };
    for (std::int64_t n = integer(0, kSurfelsPerChunk); n > 0; --n) {
      c.surfels.push_back({r(), r(), r(), r(), r(), r(), b(), b(), b(), 0.01F, 0.5F});
    }
    c.total_surfels = static_cast<std::int64_t>(c.surfels.size()) + integer(0, 100);
    return c;
  }
  Command command() {
    return {integer(0, 1LL << 50),
            integer(0, 99),
            coin() ? "" : "fuse",
            static_cast<CommandKind>(integer(1, 5)),
            "name",
            1,
            {1, 2, 3}};
  }
  StampedBodyPose bodyPose() { return {integer(0, 1LL << 50), integer(0, 1000), pose()}; }

 private:
  std::mt19937_64 random_;
};

}  // namespace rf
