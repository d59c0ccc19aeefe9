// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/result_writer.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "datasets/ply.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

Camera smallCamera() { return {32, 24, 30, 30, 15.5, 11.5, {0, 0, 0, 0, 0}}; }

struct OneFrame {
  RgbdFrame frame;
  SegmentationResult segmentation;
  ModelState state;

  explicit OneFrame(std::int64_t utime, std::int64_t seq = 0) {
    frame.utime = segmentation.utime = state.utime = utime;
    frame.seq = segmentation.seq = state.seq = seq;
    frame.colour = Image<Rgb>(32, 24);
    frame.depth_mm = Image<std::uint16_t>(32, 24, 1000);
    segmentation.score = Image<std::uint8_t>(16, 12, 255);
    segmentation.stage_ms = {{"pyramid", 1.25}, {"solve", 2.5}};
    state.camera.health = Health::kTracked;
    state.object.health = Health::kTracked;
  }
};

TEST(MaskMaker, FollowsDepthAndScore) {
  OneFrame f(1);
  f.frame.depth_mm(0, 0) = 0;
  f.segmentation.score(3, 2) = 127;
  f.segmentation.score(4, 2) = 128;
  const Image<std::uint8_t> mask =
      MaskMaker(smallCamera()).make(f.frame.depth_mm, f.segmentation.score, {}, 2);
  EXPECT_EQ(mask(0, 0), kMaskNoDepth);
  EXPECT_EQ(mask(1, 0), kMaskStatic);
  for (const int u : {6, 7}) {
    for (const int v : {4, 5}) EXPECT_EQ(mask(u, v), kMaskDynamic);
  }
  EXPECT_EQ(mask(5, 4), kMaskStatic);
  EXPECT_EQ(mask(8, 4), kMaskStatic);
}

TEST(MaskMaker, NamesTheRobotsOwnPixels) {
  OneFrame f(1);
  f.frame.depth_mm(6, 4) = 0;
  f.segmentation.score(4, 2) = 0;
  f.segmentation.label = Image<std::uint8_t>(16, 12, 0);
  f.segmentation.label(3, 2) = kSelfLabel;
  f.segmentation.label(5, 2) = kNoCluster;
  const Image<std::uint8_t> mask =
      MaskMaker(smallCamera())
          .make(f.frame.depth_mm, f.segmentation.score, f.segmentation.label, 2);
  EXPECT_EQ(mask(6, 4), kMaskNoDepth);
  EXPECT_EQ(mask(7, 4), kMaskSelf);
  EXPECT_EQ(mask(6, 5), kMaskSelf);
  EXPECT_EQ(mask(8, 4), kMaskDynamic);
  EXPECT_EQ(mask(10, 4), kMaskStatic);
}

TEST(MaskMaker, LooksUpScoresWhereDistortedPixelsGo) {
  Camera camera = smallCamera();
  camera.distortion = {0.2, 0, 0, 0, 0};
  Image<std::uint8_t> score(16, 12, 255);
  for (int v = 0; v < 12; ++v) score(15, v) = 0;
  MaskMaker maker(camera);
  const Image<std::uint16_t> depth(32, 24, 500);
  const Image<std::uint8_t> mask = maker.make(depth, score, {}, 2);
  int dynamic = 0;
  for (int v = 0; v < 24; ++v) {
    for (int u = 0; u < 32; ++u) {
      const Eigen::Vector2d ideal = camera.undistort({u, v});
      const bool expected = std::clamp(ideal.x() + 0.5, 0.0, 31.0) >= 30.0;
      EXPECT_EQ(mask(u, v), expected ? kMaskDynamic : kMaskStatic) << u << " " << v;
      dynamic += mask(u, v) == kMaskDynamic;
    }
  }
  EXPECT_LT(dynamic, 48) << "barrel or pincushion moves the border column";
}

TEST(MaskMaker, RefusesOtherSizes) {
  MaskMaker maker(smallCamera());
  const Image<std::uint16_t> depth(32, 24, 500);
  EXPECT_THROW(maker.make(depth, Image<std::uint8_t>(8, 8), {}, 2), std::invalid_argument);
  EXPECT_THROW(maker.make(depth, Image<std::uint8_t>(16, 12), {}, 0), std::invalid_argument);
  EXPECT_THROW(maker.make(Image<std::uint16_t>(16, 12), Image<std::uint8_t>(16, 12), {}, 2),
               std::invalid_argument);
  EXPECT_THROW(maker.make(depth, Image<std::uint8_t>(16, 12), Image<std::uint8_t>(12, 16), 2),
               std::invalid_argument);
}

TEST(ResultWriter, EveryFrameHasALineOrIsListedAsLost) {
  const TempFolder folder;
  const std::string out = folder / "result";
  ResultWriter writer(out, smallCamera(), {true, "mode: vo\n"});
  OneFrame first(1000000, 0);
  writer.add(first.frame, first.segmentation, first.state);
  writer.addLost(2000000, 1, "a.png: is truncated, twice");
  OneFrame third(3000000, 2);
  third.state.object_exists = true;
  writer.add(third.frame, third.segmentation, third.state);
  OneFrame lost(4000000, 3);
  lost.state.camera.health = Health::kLost;
  writer.add(lost.frame, lost.segmentation, lost.state);
  writer.writeModels({{1, 2, 3, 0, 0, 1, 1, 2, 3, 0.01F, 1}}, {});

  const Trajectory camera = readTrajectory(out + "/camera.txt");
  ASSERT_EQ(camera.size(), 2U);
  EXPECT_EQ(camera[1].utime, 3000000);
  EXPECT_EQ(readTrajectory(out + "/object.txt").size(), 1U);
  EXPECT_EQ(TempFolder::read(out + "/config.yaml"), "mode: vo\n");
  EXPECT_EQ(readPly(out + "/static.ply").size(), 1U);
  EXPECT_EQ(readPly(out + "/object.ply").size(), 0U);
  EXPECT_EQ(readGreyImage(out + "/masks/3.000000.png", 32, 24)(1, 1), kMaskStatic);

  const CovarianceFile covariances = readCovariances(out + "/covariance.csv");
  EXPECT_EQ(covariances.camera.size(), 3U) << "lost frames too, missing ones not";
  EXPECT_EQ(covariances.object.size(), 1U);

  const std::string csv = TempFolder::read(out + "/frames.csv");
  std::istringstream rows(csv);
  std::string row;
  std::vector<std::string> all;
  while (std::getline(rows, row)) all.push_back(row);
  ASSERT_EQ(all.size(), 5U);
  const auto commas = std::count(all[0].begin(), all[0].end(), ',');
  for (const std::string& r : all) EXPECT_EQ(std::count(r.begin(), r.end(), ','), commas) << r;
  EXPECT_EQ(all[2].rfind("2000000,1,lost,", 0), 0U);
  EXPECT_NE(all[1].find("segment.pyramid=1.250;segment.solve=2.500"), std::string::npos);
  EXPECT_EQ(writer.framesWritten(), 3);
  EXPECT_EQ(writer.framesLost(), 1);
}

TEST(ResultWriter, LeavesOutABodyThatWasAFalseAlarm) {
  const TempFolder folder;
  const auto times = [&] {
    std::vector<std::int64_t> out;
    for (const StampedPose& p : readTrajectory(folder / "object.txt")) out.push_back(p.utime);
    return out;
  };
  {
    ResultWriter writer(folder.path(), smallCamera(), {false, "", 2});
    std::int64_t utime = 0;
    const auto add = [&](bool exists, Health health = Health::kTracked) {
      OneFrame f(++utime);
      f.state.object_exists = exists;
      f.state.object.health = health;
      writer.add(f.frame, f.segmentation, f.state);
    };
    for (const bool exists : {false, true, true, false, true, true}) add(exists);
    EXPECT_TRUE(times().empty()) << "two frames: not known yet";
    add(true, Health::kLost);
    EXPECT_TRUE(times().empty()) << "no pose in that frame";
    add(true);
    EXPECT_EQ(times(), (std::vector<std::int64_t>{5, 6, 8}));
    add(true);
    EXPECT_EQ(times().back(), 9) << "no delay any more";
    add(false);
    add(true);
    EXPECT_EQ(times().size(), 4U) << "the next body waits again";
  }
  EXPECT_EQ(times(), (std::vector<std::int64_t>{5, 6, 8, 9, 11})) << "kept when the run ends";
}

TEST(ResultWriter, KeepsThePriorsThatWereUsed) {
  const TempFolder folder;
  ResultWriter writer(folder.path(), smallCamera(), {});
  MotionPrior prior;
  prior.utime_b = 5;
  writer.addPrior(prior);
  EXPECT_FALSE(std::filesystem::exists(folder / "camera_prior.txt"));
  prior.utime_b = 7;
  prior.camera = prior.object = PriorState::kValid;
  prior.object_kind = ObjectPriorKind::kWorldFrame;
  prior.T_XOb.t.x() = 3;
  writer.addPrior(prior);
  ASSERT_EQ(readTrajectory(folder / "camera_prior.txt").size(), 1U);
  EXPECT_EQ(readTrajectory(folder / "object_prior.txt").at(0).pose.t.x(), 3);
}

TEST(ResultWriter, KeepsWhereKinematicsAlonePutTheObject) {
  const TempFolder folder;
  ResultWriter writer(folder.path(), smallCamera(), {});
  MotionPrior prior;
  prior.utime_b = 7;
  prior.object = PriorState::kValid;
  prior.object_kind = ObjectPriorKind::kCameraFrame;
  prior.T_XOb.t = {0, 0, 0.5};
  writer.addPrior(prior);
  EXPECT_FALSE(std::filesystem::exists(folder / "object_prior.txt")) << "no camera pose";
  prior.utime_b = 8;
  prior.camera = PriorState::kValid;
  prior.T_WCb = {Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitY())), {1, 2, 3}};
  writer.addPrior(prior);
  const Trajectory object = readTrajectory(folder / "object_prior.txt");
  ASSERT_EQ(object.size(), 1U);
  EXPECT_LT((object[0].pose.t - Vec3(1.5, 2, 3)).norm(), 1e-8);
}

TEST(ResultWriter, RemovesOldResultsOnly) {
  const TempFolder folder;
  folder.write("masks/1.000000.png", "old");
  folder.write("masks/notes.png", "mine");
  folder.write("static.ply", "old");
  ResultWriter writer(folder.path(), smallCamera(), {});
  EXPECT_FALSE(std::filesystem::exists(folder / "masks/1.000000.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "masks/notes.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "static.ply"));
}

TEST(ResultWriter, RefusesResultsOfDifferentFrames) {
  const TempFolder folder;
  ResultWriter writer(folder.path(), smallCamera(), {});
  OneFrame f(1000000);
  f.state.utime = 2;
  EXPECT_THROW(writer.add(f.frame, f.segmentation, f.state), std::invalid_argument);
  EXPECT_THROW(ResultWriter("/proc/none/here", smallCamera(), {}), DatasetError);
}

}  // namespace
}  // namespace rf
