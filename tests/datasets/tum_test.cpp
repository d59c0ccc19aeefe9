// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/tum.hpp"

#include "config/yaml.hpp"
#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

constexpr const char* kCamera =
    "width: 32\nheight: 24\nfx: 30\nfy: 31\ncx: 15.5\ncy: 11.5\ndepth_factor: 5000\n";

void writeFrame(const TempFolder& folder, int i) {
  std::filesystem::create_directories(folder / "rgb");
  std::filesystem::create_directories(folder / "depth");
  writeColourImage(folder / ("rgb/" + std::to_string(i) + ".png"),
                   Image<Rgb>(32, 24, Rgb{static_cast<std::uint8_t>(i), 0, 0}));
  writeDepthImage(folder / ("depth/" + std::to_string(i) + ".png"),
                  Image<std::uint16_t>(32, 24, static_cast<std::uint16_t>(5000 * i)));
}

void writeSequence(const TempFolder& folder) {
  folder.write("camera.yaml", kCamera);
  folder.write("rgb.txt", "# rgb\n1.005 rgb/1.png\n2.010 rgb/2.png\n3.0 rgb/3.png\n9 rgb/9.png\n");
  folder.write("depth.txt",
               "1.000 depth/1.png\n2.000 depth/2.png\n3.019 depth/3.png\n5 depth/5.png\n");
  for (const int i : {1, 2, 3}) writeFrame(folder, i);
}

TEST(Associate, TakesNearestOneToOneWithin20Ms) {
  const std::vector<TumImage> depth = {{1000000, "d0"}, {1010000, "d1"}, {2000000, "d2"}};
  const std::vector<TumImage> colour = {{1008000, "c0"}, {1975000, "c1"}, {2020000, "c2"}};
  const TumIndex index = associate(depth, colour);
  ASSERT_EQ(index.frames.size(), 2U);
  EXPECT_EQ(index.frames[0].depth_path, "d1") << "c0 is nearest to d1, so d0 stays alone";
  EXPECT_EQ(index.frames[0].utime, 1010000);
  EXPECT_EQ(index.frames[0].colour_utime, 1008000);
  EXPECT_EQ(index.frames[1].colour_path, "c2") << "20 ms is within, 25 ms is not";
  EXPECT_EQ(index.depth_without_colour, 1U);
  EXPECT_EQ(index.colour_without_depth, 1U);
}

TEST(TumDataset, LoadsFramesAtDepthTime) {
  const TempFolder folder;
  writeSequence(folder);
  const TumDataset dataset(folder.path());
  ASSERT_EQ(dataset.size(), 3U);
  EXPECT_EQ(dataset.index().depth_without_colour, 1U);
  EXPECT_EQ(dataset.index().colour_without_depth, 1U);
  const TumDataset::Loaded loaded = dataset.load(2);
  ASSERT_TRUE(loaded.frame) << loaded.problem;
  EXPECT_EQ(loaded.frame->utime, 3019000);
  EXPECT_EQ(loaded.frame->colour_utime, 3000000);
  EXPECT_EQ(loaded.frame->seq, 2);
  EXPECT_EQ(loaded.frame->depth_mm(5, 5), 3000);
  EXPECT_EQ(loaded.frame->colour(5, 5).r, 3);
}

TEST(TumDataset, SaysWhichFileIsUnusableAndGoesOn) {
  const TempFolder folder;
  writeSequence(folder);
  std::filesystem::remove(folder / "depth/1.png");
  writeDepthImage(folder / "depth/2.png", Image<std::uint16_t>(16, 16, 7));
  const TumDataset dataset(folder.path());
  EXPECT_FALSE(dataset.load(0).frame);
  EXPECT_NE(dataset.load(0).problem.find("depth/1.png: cannot be opened"), std::string::npos);
  EXPECT_NE(dataset.load(1).problem.find("image size 16x16: must be 32x24"), std::string::npos);
  EXPECT_TRUE(dataset.load(2).frame);
}

TEST(TumDataset, AcceptsAssociationFilesInBothOrders) {
  for (const char* text : {"1.005 rgb/1.png 1.000 depth/1.png\n2.01 rgb/2.png 2 depth/2.png\n",
                           "1.000 depth/1.png 1.005 rgb/1.png\n2 depth/2.png 2.01 rgb/2.png\n"}) {
    const TempFolder folder;
    folder.write("camera.yaml", kCamera);
    folder.write("associated.txt", text);
    writeFrame(folder, 1);
    writeFrame(folder, 2);
    const TumDataset dataset(folder.path());
    ASSERT_EQ(dataset.size(), 2U);
    EXPECT_EQ(dataset.index().frames[0].utime, 1000000);
    EXPECT_TRUE(dataset.load(1).frame) << dataset.load(1).problem;
  }
}

TEST(TumDataset, TellsDepthByHeaderWhenNamesDoNot) {
  const TempFolder folder;
  folder.write("camera.yaml", kCamera);
  folder.write("assoc.txt", "1.0 a.png 1.005 b.png\n");
  writeDepthImage(folder / "b.png", Image<std::uint16_t>(32, 24, 5000));
  writeColourImage(folder / "a.png", Image<Rgb>(32, 24));
  const TumDataset dataset(folder.path());
  EXPECT_EQ(dataset.index().frames.at(0).utime, 1005000);
  std::filesystem::remove(folder / "a.png");
  EXPECT_NE(messageOf<DatasetError>([&] { TumDataset again(folder.path()); }).find("cannot tell"),
            std::string::npos);
}

TEST(TumDataset, SortsAndCountsRepeatedTimes) {
  const TempFolder folder;
  writeSequence(folder);
  folder.write("depth.txt", "2.000 depth/2.png\n1.000 depth/1.png\n2.000 depth/3.png\n");
  const TumIndex index = indexTumFolder(folder.path());
  ASSERT_EQ(index.frames.size(), 2U);
  EXPECT_EQ(index.frames[0].utime, 1000000);
  EXPECT_EQ(index.dropped_lines, 1U);
  ASSERT_EQ(index.warnings.size(), 1U);
}

TEST(TumDataset, ClearErrorsForUnusableFolders) {
  const TempFolder folder;
  EXPECT_NE(messageOf<DatasetError>([&] { indexTumFolder(folder.path()); }).find("has neither"),
            std::string::npos);
  EXPECT_NE(messageOf<DatasetError>([&] { indexTumFolder(folder / "none"); }).find("is no folder"),
            std::string::npos);
  writeSequence(folder);
  folder.write("camera.yaml", "width: 32\nheight: 24\nfx: 30\n");
  EXPECT_NE(messageOf<DatasetError>([&] { TumDataset d(folder.path()); }).find("fy: is missing"),
            std::string::npos);
  folder.write("camera.yaml", std::string(kCamera) + "k1: .nan\n");
  EXPECT_NE(messageOf<ConfigError>([&] { TumDataset d(folder.path()); }).find("k1"),
            std::string::npos);
  folder.write("camera.yaml", kCamera);
  folder.write("rgb.txt", "one rgb/1.png\n");
  EXPECT_NE(
      messageOf<DatasetError>([&] { TumDataset d(folder.path()); }).find("rgb.txt:1: timestamp"),
      std::string::npos);
}

TEST(Calibration, RoundTrips) {
  const TempFolder folder;
  Calibration c;
  c.camera = {640, 480, 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
  c.depth_factor = 5000;
  writeCalibration(folder / "camera.yaml", c);
  const Calibration back = readCalibration(folder / "camera.yaml");
  EXPECT_EQ(back.camera, c.camera);
  EXPECT_EQ(back.depth_factor, 5000);
}

}  // namespace
}  // namespace rf
