// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>
#include <unistd.h>

#include "datasets/error.hpp"
#include "models.hpp"
#include "plot.hpp"
#include "result.hpp"
#include "sheet.hpp"
#include "splat.hpp"

namespace rf::render {
namespace {

SE3 turned(double angle, const Vec3& axis, const Vec3& t) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), t};
}

/// A level camera in a z-up world: looks along +y, its y axis down.
SE3 levelCamera(const Vec3& t) { return turned(-std::numbers::pi / 2, Vec3::UnitX(), t); }

Trajectory line(const SE3& first, const Vec3& step, int count) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back({1'000'000 + i * 33'333, SE3(first.q, first.t + i * step)});
  }
  return poses;
}

TEST(SkyAxis, IsMinusYInTheFirstCamerasFrame) {
  EXPECT_EQ(skyAxis(line(SE3(), Vec3::UnitX(), 3)), Vec3(-Vec3::UnitY()));
}

TEST(SkyAxis, IsZForALevelOrTiltedCameraInAZUpWorld) {
  EXPECT_EQ(skyAxis(line(levelCamera({1, 2, 1}), Vec3::UnitX(), 3)), Vec3::UnitZ());
  const SE3 tilted = turned(-2.4, Vec3::UnitX(), {0, 0, 1});
  EXPECT_EQ(skyAxis(line(tilted, Vec3::UnitX(), 3)), Vec3::UnitZ());
}

TEST(GroundPlane, RightTimesUpPointsToTheSky) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 sky = sign * Vec3::Unit(axis);
      const GroundPlane plane = groundPlane(sky);
      EXPECT_EQ(plane.right.cross(plane.up), sky) << "axis " << axis << " sign " << sign;
    }
  }
}

TEST(SpreadOver, TakesFirstAndLast) {
  EXPECT_EQ(spreadOver(50, 3), (std::vector<std::size_t>{0, 25, 49}));
  EXPECT_EQ(spreadOver(2, 12), (std::vector<std::size_t>{0, 1}));
  EXPECT_TRUE(spreadOver(0, 12).empty());
}

TEST(Overlay, PaintsEachClass) {
  const cv::Mat colour(1, 3, CV_8UC3, cv::Scalar(100, 100, 100));
  cv::Mat mask(1, 3, CV_8UC1);
  for (int u = 0; u < 3; ++u) mask.at<std::uint8_t>(0, u) = static_cast<std::uint8_t>(u);
  const cv::Mat out = overlay(colour, mask);
  const auto none = out.at<cv::Vec3b>(0, 0);
  const auto fixed = out.at<cv::Vec3b>(0, 1);
  const auto moving = out.at<cv::Vec3b>(0, 2);
  EXPECT_TRUE(none[0] == none[1] && none[1] == none[2]);
  EXPECT_GT(fixed[0], fixed[2]);
  EXPECT_GT(moving[2], moving[0] + 80);
}

SurfelPoint surfelAt(float x, float y, float z, float nz, std::uint8_t red) {
  SurfelPoint s;
  s.x = x;
  s.y = y;
  s.z = z;
  s.nz = nz;
  s.red = red;
  s.radius = 0.1F;
  return s;
}

TEST(Splat, NearestFacingDiscWinsAndBacksAreLeftOut) {
  const View view{100, 100, false, 100, {}};
  Raster raster = emptyRaster(view);
  splat({surfelAt(0, 0, 2, -1, 200), surfelAt(0, 0, 1, -1, 100), surfelAt(0, 0, 0.5F, 1, 250)},
        SE3(), view, 0, raster);
  EXPECT_FLOAT_EQ(raster.depth.at<float>(50, 50), 1.0F);
  EXPECT_EQ(raster.colour.at<cv::Vec3b>(50, 50)[2], 100);
}

TEST(Splat, DiscHasItsRadiusInPixels) {
  const View view{100, 100, true, 100, {}};
  Raster raster = emptyRaster(view);
  splat({surfelAt(0, 0, 1, -1, 100)}, SE3(), view, 0, raster);
  int drawn = 0;
  for (const float z : cv::Mat_<float>(raster.depth)) drawn += std::isfinite(z) ? 1 : 0;
  const double radius_px = 1.3 * 0.1 * 100;
  EXPECT_NEAR(drawn, std::numbers::pi * radius_px * radius_px, 20);
}

TEST(LookAt, PutsTheTargetInTheMiddleAndUpUpwards) {
  View view{200, 100, false, 50, lookAt({1, 2, 3}, {4, 2, 3}, Vec3::UnitZ())};
  EXPECT_TRUE(toPixel(view, {4, 2, 3}).isApprox(Vec3(100, 50, 3)));
  EXPECT_LT(toPixel(view, {4, 2, 4}).y(), 50);
  EXPECT_GT(toPixel(view, {4, 1, 3}).x(), 100);
}

TEST(OverlayTracks, MovesEstimateAndPriorIntoTheTruthsWorld) {
  const Tracks truth{line(levelCamera({1, 2, 1}), {0.1, 0, 0}, 10),
                     line(SE3(Eigen::Quaterniond::Identity(), {0, 4, 0}), {0, 0.1, 0}, 10)};
  const SE3 T_EW = turned(0.7, Vec3(1, 2, 3).normalized(), {5, -1, 2});
  const SE3 T_OX = turned(0.3, Vec3::UnitY(), {0.2, 0.1, -0.3});
  Tracks estimate;
  for (const auto& p : truth.camera) estimate.camera.push_back({p.utime, T_EW * p.pose});
  for (const auto& p : truth.object) estimate.object.push_back({p.utime, T_EW * p.pose * T_OX});
  const Overlaid lines = overlayTracks(truth, {}, estimate, Vec3(9, 9, 9));
  ASSERT_EQ(lines.series.size(), 6U);
  for (const std::size_t first : {0U, 3U}) {
    const auto& wanted = lines.series[first].points;
    const auto& drawn = lines.series[first + 2].points;
    ASSERT_EQ(wanted.size(), drawn.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_LT((wanted[i] - drawn[i]).norm(), 1e-9) << lines.series[first].name << " " << i;
    }
  }
}

TEST(OverlayTracks, LeavesOutAnObjectWhoseFrameMeansNothing) {
  const Tracks estimate{line(SE3(), {0.1, 0, 0}, 3), line(SE3(), {0.1, 0, 0}, 3)};
  EXPECT_TRUE(overlayTracks({}, {}, estimate, std::nullopt).series[5].points.empty());
  EXPECT_EQ(overlayTracks({}, {}, estimate, Vec3(0, 0, 1)).series[5].points.size(), 3U);
  EXPECT_EQ(overlayTracks({}, estimate, estimate, std::nullopt).series[5].points.size(), 3U);
}

TEST(Pictures, EmptyInputsStillGivePictures) {
  EXPECT_FALSE(contactSheet({}, "nothing").empty());
  EXPECT_FALSE(trajectoryPlot({}, {}, "nothing", "").empty());
  const ModelScene scene{{surfelAt(0, 0, 1, -1, 90)}, {}, line(SE3(), {0, 0, 0}, 1), {}};
  EXPECT_FALSE(modelPicture(scene, "one surfel").empty());
}

class FrameRows : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const auto* name = testing::UnitTest::GetInstance()->current_test_info()->name();
    path_ = std::filesystem::temp_directory_path() /
            ("rf_render_" + std::string(name) + std::to_string(::getpid()) + ".csv");
    std::ofstream(path_) << text;
    return path_.string();
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_;
};

TEST_F(FrameRows, ColumnsAreFoundByName) {
  const auto rows = readFrameRows(
      write("seq,utime,note,dynamic_share,health\n7,1000,x,0.25,tracked\n8,2000,,,lost\nbad\n"));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows.at(1000).seq, 7);
  EXPECT_DOUBLE_EQ(rows.at(1000).dynamic_share, 0.25);
  EXPECT_EQ(rows.at(2000).health, "lost");
  EXPECT_FALSE(rows.at(2000).has_share);
}

TEST_F(FrameRows, AMissingColumnIsNamed) {
  const std::string path = write("utime,seq,health\n");
  try {
    readFrameRows(path);
    FAIL() << "no error";
  } catch (const DatasetError& e) {
    EXPECT_NE(std::string(e.what()).find("dynamic_share"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find(path), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace rf::render
