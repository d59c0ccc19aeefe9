// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/self_filter.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr double kMargin = 0.02;

Camera camera() {
  Camera c;
  c.width = 160;
  c.height = 120;
  c.fx = 142;
  c.fy = 141;
  c.cx = 79.2;
  c.cy = 60.4;
  return c;
}

/// A margin alone, so that every border is in closed form.
SelfFilterConfig plain() {
  SelfFilterConfig config;
  config.margin_m = kMargin;
  config.gate_sigma = 0;
  return config;
}

PosedShape shape(RobotShapeKind kind, const Vec3& half, const SE3& T_CS) {
  return {kind, half, T_CS};
}

SE3 at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

/// Compares the mask of a flat depth image with how far each measured point lies outside the grown
/// shape (metres, negative inside), leaving out points within a hair of its border.
void expectMask(const SelfFilter& filter, const PosedShape& s, int mm,
                const std::function<double(const Vec3&)>& outside_by) {
  const Camera c = camera();
  const Image<std::uint16_t> depth(c.width, c.height, static_cast<std::uint16_t>(mm));
  const SelfMask found = filter.find({&s, 1}, depth);
  int robot = 0;
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const double by = outside_by(c.backProject(u, v, mm * 1e-3));
      if (std::abs(by) < 1e-5) continue;
      ASSERT_EQ(found.mask(u, v), by < 0 ? 1 : 0) << u << " " << v << " at " << mm << " mm";
      robot += by < 0 ? 1 : 0;
    }
  }
  EXPECT_NEAR(found.pixels, robot, 4);
}

TEST(SelfFilter, SphereInClosedForm) {
  const SelfFilter filter(plain(), camera());
  const Vec3 centre(0.05, -0.03, 0.8);
  const PosedShape s =
      shape(RobotShapeKind::kSphere, Vec3::Constant(0.1), at(centre.x(), centre.y(), centre.z()));
  for (const int mm : {600, 690, 720, 800, 900, 915, 950}) {
    expectMask(filter, s, mm, [&](const Vec3& p) { return (p - centre).norm() - 0.1 - kMargin; });
  }
}

TEST(SelfFilter, TurnedBoxInClosedForm) {
  const SelfFilter filter(plain(), camera());
  const Vec3 half(0.05, 0.12, 0.08);
  const Eigen::Quaterniond q = Eigen::AngleAxisd(0.5, Vec3::UnitY()) *
                               Eigen::AngleAxisd(-0.3, Vec3::UnitX()) *
                               Eigen::AngleAxisd(0.8, Vec3::UnitZ());
  const PosedShape s = shape(RobotShapeKind::kBox, half, {q, Vec3(-0.1, 0.04, 0.7)});
  const SE3 T_SC = s.T_CS.inverse();
  for (const int mm : {540, 620, 700, 780, 860}) {
    expectMask(filter, s, mm, [&](const Vec3& p) {
      const Vec3 p_S = T_SC * p;
      return (p_S.cwiseAbs() - half - Vec3::Constant(kMargin)).maxCoeff();
    });
  }
}

TEST(SelfFilter, TurnedCylinderInClosedForm) {
  const SelfFilter filter(plain(), camera());
  const Vec3 half(0.06, 0.06, 0.2);
  const Eigen::Quaterniond q =
      Eigen::AngleAxisd(1.1, Vec3::UnitX()) * Eigen::AngleAxisd(0.4, Vec3::UnitY());
  const PosedShape s = shape(RobotShapeKind::kCylinder, half, {q, Vec3(0.02, 0.0, 0.9)});
  const SE3 T_SC = s.T_CS.inverse();
  for (const int mm : {750, 850, 900, 1000}) {
    expectMask(filter, s, mm, [&](const Vec3& p) {
      const Vec3 p_S = T_SC * p;
      return std::max(p_S.head<2>().norm() - half.x(), std::abs(p_S.z()) - half.z()) - kMargin;
    });
  }
}

TEST(SelfFilter, KeepsWhatIsHeldInFrontAndWhatIsBehind) {
  const SelfFilter filter(plain(), camera());
  const PosedShape plate =
      shape(RobotShapeKind::kBox, {0.2, 0.2, 0.05}, at(0, 0, 0.8));  // 0.75 to 0.85 m
  const Camera c = camera();
  const auto pixels = [&](std::uint16_t mm) {
    return filter.find({&plate, 1}, Image<std::uint16_t>(c.width, c.height, mm));
  };
  EXPECT_EQ(pixels(720).pixels, 0) << "held in front of it";
  EXPECT_EQ(pixels(720).behind, 0);
  EXPECT_GT(pixels(740).pixels, 4000);
  EXPECT_GT(pixels(860).pixels, 4000);
  EXPECT_EQ(pixels(860).behind, 0) << "within the margin";
  EXPECT_EQ(pixels(2000).pixels, 0) << "seen through: the kinematics are wrong";
  EXPECT_GT(pixels(2000).behind, 4000);
  EXPECT_EQ(pixels(0).pixels, 0) << "no depth";
  EXPECT_EQ(pixels(0).behind, 0);
}

TEST(SelfFilter, NoiseOpensTheGateAlongTheRay) {
  SelfFilterConfig config = plain();
  config.gate_sigma = 3;
  config.sigma_base_m = 0.001;
  config.sigma_growth = 0.002;
  const SelfFilter filter(config, camera());
  const PosedShape plate = shape(RobotShapeKind::kBox, {0.5, 0.5, 0.05}, at(0, 0, 2.0));
  const Camera c = camera();
  // sigma at 1.916 m: 1 + 2 * 1.516^2 = 5.6 mm; the grown front is at 1.93 m, the gate 16.8 mm.
  const auto share = [&](std::uint16_t mm) {
    return filter.find({&plate, 1}, Image<std::uint16_t>(c.width, c.height, mm)).pixels;
  };
  EXPECT_GT(share(1916), 0);
  EXPECT_EQ(share(1910), 0);
}

TEST(SelfFilter, CameraInsideAGrownShapeSeesItFromWithin) {
  const SelfFilter filter(plain(), camera());
  const Camera c = camera();
  const PosedShape housing = shape(RobotShapeKind::kBox, {0.1, 0.03, 0.03}, at(0, 0, -0.01));
  const SelfMask far = filter.find({&housing, 1}, Image<std::uint16_t>(c.width, c.height, 500));
  EXPECT_EQ(far.pixels, 0);
  EXPECT_EQ(far.behind, 0) << "looking out of one's own head is nothing wrong";
  const PosedShape around = shape(RobotShapeKind::kSphere, Vec3::Constant(0.6), at(0, 0, 0));
  const SelfMask near = filter.find({&around, 1}, Image<std::uint16_t>(c.width, c.height, 400));
  EXPECT_EQ(near.pixels, c.width * c.height);
}

TEST(SelfFilter, ShapesBehindTheCameraAndBesideTheViewDoNothing) {
  const SelfFilter filter(plain(), camera());
  const Camera c = camera();
  const Image<std::uint16_t> depth(c.width, c.height, 1000);
  for (const SE3& pose : {at(0, 0, -1), at(5, 0, 1), at(0, -4, 1)}) {
    for (const auto kind :
         {RobotShapeKind::kBox, RobotShapeKind::kCylinder, RobotShapeKind::kSphere}) {
      const PosedShape s = shape(kind, Vec3::Constant(0.1), pose);
      const SelfMask mask = filter.find({&s, 1}, depth);
      EXPECT_EQ(mask.pixels, 0);
      EXPECT_EQ(mask.behind, 0);
    }
  }
  // From behind the camera through it into the view: only the part before it counts.
  const PosedShape beam = shape(RobotShapeKind::kBox, {0.05, 0.05, 2.0}, at(0, 0.1, 0));
  EXPECT_GT(filter.find({&beam, 1}, depth).pixels, 0);
  EXPECT_EQ(filter.find({}, depth).pixels, 0);
}

TEST(SelfFilter, FollowsTheLens) {
  Camera bent = camera();
  bent.distortion = {-0.25, 0.06, 0.001, -0.002, 0};
  const SelfFilter filter(plain(), bent);
  const Vec3 centre(0.28, 0.2, 0.8);
  const PosedShape s =
      shape(RobotShapeKind::kSphere, Vec3::Constant(0.1), at(centre.x(), centre.y(), centre.z()));
  const Image<std::uint16_t> depth(bent.width, bent.height, 800);
  const SelfMask found = filter.find({&s, 1}, depth);
  int robot = 0;
  for (int v = 0; v < bent.height; ++v) {
    for (int u = 0; u < bent.width; ++u) {
      const Eigen::Vector2d ideal = bent.undistort({u, v});
      const double by =
          (bent.backProject(ideal.x(), ideal.y(), 0.8) - centre).norm() - 0.1 - kMargin;
      if (std::abs(by) < 1e-4) continue;
      ASSERT_EQ(found.mask(u, v), by < 0 ? 1 : 0) << u << " " << v;
      robot += by < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(robot, 300);
}

void expectRefused(const SelfFilter& filter, const PosedShape& bad, const std::string& word) {
  const PosedShape good = shape(RobotShapeKind::kSphere, Vec3::Constant(0.1), at(0, 0, 1));
  const std::vector<PosedShape> shapes = {good, bad};
  try {
    filter.find(shapes, Image<std::uint16_t>(camera().width, camera().height, 1000));
    FAIL() << "no error for " << word;
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("robot shape 1"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

TEST(SelfFilter, RefusesWhatIsNoShape) {
  const SelfFilter filter(plain(), camera());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectRefused(filter, shape(RobotShapeKind::kBox, Vec3::Constant(0.1), at(nan, 0, 1)), "pose");
  PosedShape stretched = shape(RobotShapeKind::kBox, Vec3::Constant(0.1), at(0, 0, 1));
  stretched.T_CS.q.coeffs() *= 1.1;
  expectRefused(filter, stretched, "quaternion");
  expectRefused(filter, shape(RobotShapeKind::kBox, {0.1, 0, 0.1}, at(0, 0, 1)), "positive");
  expectRefused(filter, shape(RobotShapeKind::kBox, {0.1, nan, 0.1}, at(0, 0, 1)), "finite");
  expectRefused(filter, shape(static_cast<RobotShapeKind>(7), Vec3::Constant(0.1), at(0, 0, 1)),
                "kind 7");
  EXPECT_THROW(filter.find({}, Image<std::uint16_t>(10, 10, 1000)), std::invalid_argument);
  const std::vector<PosedShape> many(
      kMaxRobotShapes + 1, shape(RobotShapeKind::kSphere, Vec3::Constant(0.1), at(0, 0, 1)));
  EXPECT_THROW(filter.find(many, Image<std::uint16_t>(camera().width, camera().height, 1000)),
               std::invalid_argument);
}

}  // namespace
}  // namespace rf
