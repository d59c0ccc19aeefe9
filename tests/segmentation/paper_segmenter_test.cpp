// SPDX-License-Identifier: BSD-3-Clause
// The published modes on an analytic scene: a textured wall and a box in front of it, both moving.
#include "segmentation/paper_segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

constexpr double kWall = 3.0, kBox = 1.5;                   // metres
constexpr double kCameraStep = 0.005, kObjectStep = 0.020;  // per frame, to the right

Camera testCamera() {
  Camera c;
  c.width = 320;
  c.height = 240;
  c.fx = c.fy = 262;
  c.cx = 159.5;
  c.cy = 119.5;
  return c;
}

double texture(double x, double y) {
  return 0.5 + 0.2 * std::sin(12 * x) + 0.2 * std::sin(9 * y + 2 * x) +
         0.1 * std::sin(40 * x) * std::sin(35 * y);
}

/// Frame k; the box has moved `object_m`, the camera k steps.
RgbdFrame render(int k, double object_m) {
  const Camera c = testCamera();
  std::mt19937_64 random(static_cast<std::uint64_t>(k) + 17);
  RgbdFrame f;
  f.utime = 33333 * k;
  f.seq = k;
  f.colour = Image<Rgb>(c.width, c.height);
  f.depth_mm = Image<std::uint16_t>(c.width, c.height);
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const double camera = kCameraStep * k;
      const double bx = (u - c.cx) / c.fx * kBox + camera - object_m, by = (v - c.cy) / c.fy * kBox;
      const bool box = std::abs(bx + 0.1) < 0.35 && std::abs(by) < 0.4;
      const double z = box ? kBox : kWall;
      const double x = box ? bx + 7 : (u - c.cx) / c.fx * z + camera, y = (v - c.cy) / c.fy * z;
      const int grey = static_cast<int>(255 * texture(x, y)) + static_cast<int>(random() % 5);
      const auto byte = static_cast<std::uint8_t>(std::clamp(grey, 0, 255));
      f.colour(u, v) = {byte, byte, byte};
      f.depth_mm(u, v) =
          static_cast<std::uint16_t>(1000 * z + static_cast<double>(random() % 7) - 3);
    }
  }
  return f;
}

SE3 shift(double x) { return SE3(Mat3(Mat3::Identity()), Vec3(x, 0, 0)); }

Mat6 covariance() {
  Vec6 sigma;
  sigma << 0.003, 0.003, 0.003, 0.005, 0.005, 0.005;
  return sigma.cwiseAbs2().asDiagonal();
}

/// Priors 2 mm off the truth; the object's from arm kinematics.
MotionPrior goodPrior(int k, double object_step) {
  MotionPrior p;
  p.utime_b = 33333 * k;
  p.utime_a = 33333 * std::max(0, k - 1);
  p.seq = k;
  p.camera = PriorState::kValid;
  p.T_CaCb = shift(kCameraStep + 0.002);
  p.object_kind = ObjectPriorKind::kCameraFrame;
  p.object = PriorState::kValid;
  p.T_XOb = shift(object_step - kCameraStep);
  p.camera_cov = p.object_cov = covariance();
  return p;
}

SegmentationConfig configOf(const std::string& mode) {
  SegmentationConfig config;
  config.mode = mode;
  config.paper.levels = 4;
  return config;
}

/// Share of pixels whose label (dynamic or not) is right in frame k.
double accuracy(const SegmentationResult& r, int k, double object_m) {
  const Camera c = testCamera().reduced(2);
  double right = 0, all = 0;
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      if (r.label(u, v) == kNoCluster) continue;
      const double bx = (u - c.cx) / c.fx * kBox + kCameraStep * k - object_m;
      const double by = (v - c.cy) / c.fy * kBox;
      const bool box = std::abs(bx + 0.1) < 0.35 && std::abs(by) < 0.4;
      right += (r.score(u, v) < 128) == box ? 1 : 0;
      all += 1;
    }
  }
  return right / all;
}

void expectSane(const SegmentationResult& r) {
  EXPECT_TRUE(r.camera.T_AB.isFinite());
  EXPECT_TRUE(r.object.T_AB.isFinite());
  EXPECT_TRUE(r.camera.covariance.allFinite());
  EXPECT_TRUE(r.object.covariance.allFinite());
  EXPECT_NE(r.camera.health, Health::kInvalid);
  EXPECT_NE(r.object.health, Health::kInvalid);
  EXPECT_EQ(r.score.width(), r.label.width());
  for (float g : r.gamma) {
    EXPECT_GE(g, 0.0F);
    EXPECT_LE(g, 1.0F);
  }
}

SegmentationResult segment(PaperSegmenter& segmenter, const RgbdFrame& frame,
                           const MotionPrior& prior, const ModelState* feedback) {
  return segmenter.process(segmenter.prepare(frame), prior, feedback);
}

TEST(PaperSegmenter, FindsAFastObjectWithGoodPriors) {
  PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
  for (int k = 0; k < 6; ++k) {
    const SegmentationResult r =
        segment(segmenter, render(k, kObjectStep * k), goodPrior(k, kObjectStep), nullptr);
    expectSane(r);
    EXPECT_EQ(r.first, k == 0);
    if (k < 3) continue;  // S_T lets a switch take two frames
    EXPECT_EQ(r.hypothesis, "joint");
    EXPECT_TRUE(r.object_moving);
    EXPECT_GT(accuracy(r, k, kObjectStep * k), 0.97);
    EXPECT_NEAR(r.camera.T_AB.t.x(), kCameraStep, 0.0006);
    EXPECT_NEAR(r.object.T_AB.t.x(), kCameraStep - kObjectStep, 0.0010);
    EXPECT_EQ(r.camera.health, Health::kTracked);
    EXPECT_EQ(r.object.health, Health::kTracked);
    EXPECT_NEAR(r.dynamic_share, 0.25, 0.08);
  }
}

TEST(PaperSegmenter, TheGateKeepsAllStaticWhilePriorsAgree) {
  PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
  for (int k = 0; k < 3; ++k) {
    const SegmentationResult r = segment(segmenter, render(k, 0), goodPrior(k, 0), nullptr);
    if (k == 0) continue;
    EXPECT_EQ(r.hypothesis, "gated");
    EXPECT_FALSE(r.object_moving);
    EXPECT_EQ(r.dynamic_share, 0);
    EXPECT_EQ(r.object.T_AB, r.camera.T_AB);
    for (std::uint8_t s : r.score) ASSERT_EQ(s, 255);
  }
}

TEST(PaperSegmenter, StartsWithoutAnObjectPriorFromOutliers) {
  PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
  for (int k = 0; k < 5; ++k) {
    MotionPrior prior = goodPrior(k, 0);
    prior.object = PriorState::kMissing;
    prior.object_kind = ObjectPriorKind::kNone;
    const SegmentationResult r = segment(segmenter, render(k, kObjectStep * k), prior, nullptr);
    expectSane(r);
    EXPECT_FALSE(r.has_T_CO);
    if (k < 2) continue;
    EXPECT_EQ(r.hypothesis, "seeded");
    EXPECT_GT(accuracy(r, k, kObjectStep * k), 0.95);
    EXPECT_NEAR(r.camera.T_AB.t.x(), kCameraStep, 0.001);
    EXPECT_NEAR(r.object.T_AB.t.x(), kCameraStep - kObjectStep, 0.002);
  }
}

TEST(PaperSegmenter, BaselinesEstimateTheWorld) {
  for (const std::string mode : {"static", "static-prior", "vo"}) {
    PaperSegmenter segmenter(configOf(mode), testCamera());
    for (int k = 0; k < 4; ++k) {
      const SegmentationResult r =
          segment(segmenter, render(k, kObjectStep * k), goodPrior(k, kObjectStep), nullptr);
      expectSane(r);
      if (k < 2) continue;
      EXPECT_EQ(r.hypothesis, mode);
      EXPECT_FALSE(r.object_moving) << mode;
      EXPECT_NEAR(r.camera.T_AB.t.x(), kCameraStep, mode == "vo" ? 0.003 : 0.0006) << mode;
      if (mode == "vo") {
        EXPECT_EQ(r.dynamic_share, 0);
      } else {
        EXPECT_GT(accuracy(r, k, kObjectStep * k), 0.95) << mode;
      }
    }
  }
}

TEST(PaperSegmenter, FramesWithoutDepthFallBackToThePriorAndSaySo) {
  PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
  segment(segmenter, render(0, 0), goodPrior(0, kObjectStep), nullptr);
  RgbdFrame blind = render(1, kObjectStep);
  std::fill(blind.depth_mm.begin(), blind.depth_mm.end(), std::uint16_t{0});
  SegmentationResult r = segment(segmenter, blind, goodPrior(1, kObjectStep), nullptr);
  expectSane(r);
  EXPECT_EQ(r.camera.health, Health::kPriorOnly);
  EXPECT_NEAR(r.camera.T_AB.t.x(), kCameraStep + 0.002, 1e-12);
  EXPECT_TRUE(r.gamma.empty());
  r = segment(segmenter, render(2, 2 * kObjectStep), MotionPrior{}, nullptr);
  EXPECT_EQ(r.camera.health, Health::kLost);
  for (int k = 3; k < 6; ++k) {
    r = segment(segmenter, render(k, kObjectStep * k), goodPrior(k, kObjectStep), nullptr);
  }
  EXPECT_EQ(r.camera.health, Health::kTracked);
  EXPECT_TRUE(r.object_moving);
}

TEST(PaperSegmenter, MissingAndNonFinitePriorsAreFlagged) {
  PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
  segment(segmenter, render(0, 0), MotionPrior{}, nullptr);
  MotionPrior bad = goodPrior(1, 0);
  bad.T_CaCb.t.x() = std::numeric_limits<double>::quiet_NaN();
  bad.T_XOa.t.y() = std::numeric_limits<double>::infinity();
  for (int k = 1; k < 3; ++k) {
    const SegmentationResult r =
        segment(segmenter, render(k, 0), k == 1 ? bad : MotionPrior{}, nullptr);
    expectSane(r);
    EXPECT_EQ(r.camera.health, Health::kDegraded);
    EXPECT_NEAR(r.camera.T_AB.t.x(), kCameraStep, 0.002);
  }
}

TEST(PaperSegmenter, APriorThatContradictsTheImageIsSaid) {
  PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
  for (int k = 0; k < 2; ++k) {
    MotionPrior prior = goodPrior(k, 0);
    prior.camera_cov *= 1e-4;
    const SegmentationResult r = segment(segmenter, render(k, 0), prior, nullptr);
    if (k > 0) {
      EXPECT_EQ(r.camera.health, Health::kDegraded);
    }
  }
}

TEST(PaperSegmenter, SameBytesForEveryThreadCountAndRun) {
  std::vector<SegmentationResult> results[3];
  for (int run = 0; run < 3; ++run) {
    setThreads(run == 1 ? 2 : 1);
    PaperSegmenter segmenter(configOf("rigidfusion-paper"), testCamera());
    for (int k = 0; k < 4; ++k) {
      results[run].push_back(
          segment(segmenter, render(k, kObjectStep * k), goodPrior(k, kObjectStep), nullptr));
    }
  }
  setThreads(1);
  for (int run = 1; run < 3; ++run) {
    for (std::size_t k = 0; k < 4; ++k) {
      const SegmentationResult &a = results[0][k], &b = results[run][k];
      EXPECT_EQ(a.camera.T_AB, b.camera.T_AB);
      EXPECT_EQ(a.object.T_AB, b.object.T_AB);
      EXPECT_EQ(a.camera.covariance, b.camera.covariance);
      EXPECT_EQ(a.gamma, b.gamma);
      EXPECT_EQ(a.score, b.score);
      EXPECT_EQ(a.label, b.label);
    }
  }
}

TEST(PaperSegmenter, RefusesWhatItCannotProcess) {
  EXPECT_THROW(PaperSegmenter(configOf("rigidfusion"), testCamera()), std::invalid_argument);
  Camera bad = testCamera();
  bad.fx = 0;
  EXPECT_THROW(PaperSegmenter(configOf("vo"), bad), std::invalid_argument);
  PaperSegmenter segmenter(configOf("vo"), testCamera());
  EXPECT_THROW(segment(segmenter, RgbdFrame{}, MotionPrior{}, nullptr), std::invalid_argument);
  EXPECT_TRUE(segment(segmenter, render(0, 0), MotionPrior{}, nullptr).first);
  segmenter.reset();
  EXPECT_TRUE(segment(segmenter, render(1, 0), MotionPrior{}, nullptr).first);
}

}  // namespace
}  // namespace rf
