// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/evaluate_folders.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "../datasets/temp_folder.hpp"
#include "datasets/calibration.hpp"
#include "datasets/covariance_table.hpp"
#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "datasets/ply.hpp"
#include "datasets/text.hpp"
#include "datasets/trajectory.hpp"

namespace rf {
namespace {

/// 60 frames at 20 Hz; the object rests for 20, then moves at 0.2 m/s; the result is 1 cm/s too
/// fast.
class Sequence {
 public:
  explicit Sequence(const TempFolder& folder) {
    std::string rgb;
    std::string depth;
    std::filesystem::create_directories(folder / "seq/mask");
    std::filesystem::create_directories(folder / "res/masks");
    TrajectoryWriter truth(folder / "seq/groundtruth.txt", "T_WC");
    TrajectoryWriter object_truth(folder / "seq/object_groundtruth.txt", "T_WO");
    TrajectoryWriter odometry(folder / "seq/odometry.txt", "T_WC");
    TrajectoryWriter camera(folder / "res/camera.txt", "T_WC");
    TrajectoryWriter object(folder / "res/object.txt", "T_WO");
    for (int i = 0; i < 60; ++i) {
      const std::int64_t utime = i * 50000;
      const double s = 0.05 * i;
      const std::string name = formatTimestamp(utime) + ".png";
      rgb += formatTimestamp(utime) + " rgb/" + name + "\n";
      depth += formatTimestamp(utime) + " depth/" + name + "\n";
      truth.add(utime, at(0.3 * s));
      odometry.add(utime, at(0.36 * s));
      object_truth.add(utime, at(1 + std::max(0.0, 0.2 * (s - 1))));
      if (i != 30) camera.add(utime, at(0.31 * s));
      if (i >= 25) object.add(utime, at(2 + 0.2 * (s - 1)));
      writeGreyImage(folder / ("seq/mask/" + name), mask(8));
      if (i != 31) writeGreyImage(folder / ("res/masks/" + name), mask(4));
    }
    folder.write("seq/rgb.txt", rgb);
    folder.write("seq/depth.txt", depth);
    request.sequence = folder / "seq";
    request.result = folder / "res";
  }

  EvaluationRequest request;

 private:
  static SE3 at(double x) { return {Eigen::Quaterniond::Identity(), Vec3(x, 0, 0)}; }
  static Image<std::uint8_t> mask(int columns) {
    Image<std::uint8_t> m(16, 16, 1);
    for (int v = 0; v < 16; ++v) {
      for (int u = 0; u < columns; ++u) m(u, v) = 2;
    }
    return m;
  }
};

TEST(EvaluateFolders, ComparesErrorsWithCovariances) {
  const TempFolder folder;
  const Sequence sequence(folder);
  EXPECT_FALSE(evaluateFolders(sequence.request).camera_consistency);
  CovarianceTable table(folder / "res/covariance.csv");
  for (int i = 0; i < 60; ++i) {
    ModelState state;
    state.utime = i * 50000;
    state.object_exists = i >= 25;
    // 1 cm/s too fast: sigma grows alike, along x; the object is right.
    const double sigma = 1e-6 + 0.01 * 0.05 * i;
    state.camera.covariance = state.object.covariance = sigma * sigma * Mat6::Identity();
    state.camera.health = state.object.health = Health::kTracked;
    table.add(state);
  }
  const EvaluationReport r = evaluateFolders(sequence.request);
  ASSERT_TRUE(r.camera_consistency && r.object_consistency);
  EXPECT_EQ(r.camera_consistency->samples, 58U);
  EXPECT_NEAR(r.camera_consistency->pose.mean, 1.0 / 6.0, 0.01);
  EXPECT_NEAR(r.camera_consistency->translation.mean, 1.0 / 3.0, 0.01);
  EXPECT_EQ(r.camera_consistency->misplaced, 0U);
  EXPECT_NEAR(r.object_consistency->pose.mean, 0, 1e-6);
  const YAML::Node json = YAML::Load(toJson(r));
  EXPECT_NEAR(json["camera"]["nees"]["pose"]["mean"].as<double>(), 1.0 / 6.0, 0.01);
  EXPECT_EQ(json["object"]["nees"]["samples"].as<int>(), 34);
}

TEST(EvaluateFolders, MeasuresAllThatIsThere) {
  const TempFolder folder;
  const Sequence sequence(folder);
  const EvaluationReport r = evaluateFolders(sequence.request);
  EXPECT_EQ(r.camera->posed, 59U);
  EXPECT_NEAR(r.camera->rpe.translation.rmse, 0.01, 1e-6);
  EXPECT_NEAR(r.camera_prior->rpe.translation.rmse, 0.06, 1e-6);
  EXPECT_EQ(r.camera_prior->posed, 60U);
  EXPECT_NEAR(r.object->ate_first.max, 0, 1e-6) << "a constant offset is none";
  EXPECT_FALSE(r.object_prior);
  EXPECT_EQ(r.fast->frames, 40U) << "frame 20 on: central differences give it half the speed";
  EXPECT_EQ(r.fast->missing, 1U);
  EXPECT_NEAR(r.fast->iou_median, 0.5, 1e-12);
  EXPECT_NEAR(r.fast->iou_min, 0.0, 1e-12);
  EXPECT_FALSE(r.static_model);
}

TEST(EvaluateFolders, PriorsOfTheResultAndOptionsGoFirst) {
  const TempFolder folder;
  Sequence sequence(folder);
  std::filesystem::copy_file(folder / "seq/groundtruth.txt", folder / "res/camera_prior.txt");
  EXPECT_LT(evaluateFolders(sequence.request).camera_prior->ate_first.rmse, 1e-9);
  sequence.request.camera_prior = "none";
  EXPECT_FALSE(evaluateFolders(sequence.request).camera_prior);
}

TEST(EvaluateFolders, CountsTheMapOnWhatMovesWhereThereIsNoTrueSurface) {
  const TempFolder folder;
  const Sequence sequence(folder);
  // Seen from x = 0.31 s in frame k: the masks' left half moves, at 2 m where there is depth.
  writePly(folder / "res/static.ply", {{-0.5F, 0, 2.0F}, {0.5F, 0, 2.0F}, {-0.5F, 0, 2.5F}});
  EXPECT_FALSE(evaluateFolders(sequence.request).static_on_moving) << "no camera.yaml";
  const Calibration calibration{{16, 16, 16, 16, 8, 8, {}}, 5000};
  writeCalibration(folder / "seq/camera.yaml", calibration);
  std::filesystem::create_directories(folder / "seq/depth");
  std::filesystem::remove_all(folder / "seq/mask");
  std::filesystem::create_directories(folder / "seq/mask");
  Image<std::uint8_t> mask(16, 16, 1);
  for (int v = 0; v < 16; ++v) {
    for (int u = 0; u < 8; ++u) mask(u, v) = 2;
  }
  const std::string name = formatTimestamp(0) + ".png";
  writeGreyImage(folder / ("seq/mask/" + name), mask);
  EXPECT_NE(messageOf<DatasetError>([&] { evaluateFolders(sequence.request); }).find(name),
            std::string::npos)
      << "a depth image that is not there";
  writeDepthImage(folder / ("seq/depth/" + name), Image<std::uint16_t>(16, 16, 10000));
  const EvaluationReport r = evaluateFolders(sequence.request);
  ASSERT_TRUE(r.static_on_moving);
  EXPECT_EQ(r.static_on_moving->frames, 1U);
  EXPECT_EQ(r.static_on_moving->surfels, 3U);
  EXPECT_EQ(r.static_on_moving->on_moving, 1U);
  EXPECT_NE(toText(r).find("1 of 3 surfels, 33.3 %"), std::string::npos);
  EXPECT_EQ(YAML::Load(toJson(r))["static_on_moving"]["on_moving"].as<int>(), 1);
}

TEST(EvaluateFolders, SaysWhatIsAbsentAndRefusesWhatIsBroken) {
  const TempFolder folder;
  const Sequence sequence(folder);
  std::filesystem::remove(folder / "seq/object_groundtruth.txt");
  std::filesystem::remove_all(folder / "res/masks");
  const EvaluationReport r = evaluateFolders(sequence.request);
  EXPECT_FALSE(r.object);
  EXPECT_FALSE(r.fast);
  EXPECT_EQ(r.notes.size(), 2U);
  folder.write("res/camera.txt", "1 0 0 nan 0 0 0 1\n");
  EXPECT_NE(messageOf<DatasetError>([&] {
              evaluateFolders(sequence.request);
            }).find("camera.txt:1: tz = nan"),
            std::string::npos);
  std::filesystem::remove(folder / "res/camera.txt");
  EXPECT_THROW(evaluateFolders(sequence.request), DatasetError);
}

TEST(EvaluateFolders, EachFrameHasItsOwnNumbers) {
  const TempFolder folder;
  Sequence sequence(folder);
  EXPECT_TRUE(evaluateFolders(sequence.request).each_frame.empty()) << "only when asked for";
  sequence.request.each_frame = true;
  const std::vector<FrameScore> f = evaluateFolders(sequence.request).each_frame;
  ASSERT_EQ(f.size(), 60U);
  EXPECT_NEAR(*f[40].camera_error, 0.01 * 0.05 * 40, 1e-6) << "1 cm/s too fast for 2 s";
  EXPECT_FALSE(f[30].camera_error);
  EXPECT_NEAR(*f[40].object_speed, 0.2, 1e-6);
  EXPECT_NEAR(*f[40].object_displacement, 0.2, 0.011) << "rests until frame 19 or 20";
  EXPECT_NEAR(*f[10].object_displacement, 0.0, 1e-9);
  EXPECT_NEAR(*f[5].dynamic_share, 0.5, 1e-9);
  EXPECT_NEAR(f[5].pixels->iou(), 0.5, 1e-9) << "also while the object rests";
  EXPECT_NEAR(f[31].pixels->dynamicAccuracy(), 0.0, 1e-9) << "a missing mask found nothing";
  std::filesystem::remove_all(folder / "res/masks");
  EXPECT_FALSE(evaluateFolders(sequence.request).each_frame[5].pixels);
}

TEST(EvaluateFolders, JsonHasTheNumbersOfTheTable) {
  const TempFolder folder;
  const Sequence sequence(folder);
  const EvaluationReport r = evaluateFolders(sequence.request);
  const YAML::Node json = YAML::Load(toJson(r));  // JSON is YAML
  EXPECT_NEAR(json["camera"]["rpe_cm_per_s"]["rmse"].as<double>(), 1.0, 1e-4);
  EXPECT_NEAR(json["segmentation_fast"]["iou_median"].as<double>(), 0.5, 1e-6);
  EXPECT_TRUE(json["static_model"].IsNull());
  EXPECT_NE(toText(r).find("camera prior"), std::string::npos);
}

}  // namespace
}  // namespace rf
