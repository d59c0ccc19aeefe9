// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/image_files.hpp"

#include "datasets/error.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

Image<std::uint16_t> ramp(int width, int height) {
  Image<std::uint16_t> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<std::uint16_t>(i * 37);
  return image;
}

TEST(ImageFiles, PngRoundTrips) {
  const TempFolder folder;
  const Image<std::uint16_t> depth = ramp(40, 30);
  writeDepthImage(folder / "d.png", depth);
  EXPECT_EQ(readDepthImage(folder / "d.png", 40, 30), depth);
  Image<Rgb> colour(20, 16, Rgb{10, 20, 30});
  colour(3, 4) = Rgb{255, 0, 1};
  writeColourImage(folder / "c.png", colour);
  EXPECT_EQ(readColourImage(folder / "c.png", 20, 16), colour);
  const Image<std::uint8_t> grey(16, 20, 2);
  writeGreyImage(folder / "g.png", grey);
  EXPECT_EQ(readGreyImage(folder / "g.png", 16, 20), grey);
  const ImageHeader header = readImageHeader(folder / "d.png");
  EXPECT_EQ(header.width, 40);
  EXPECT_EQ(header.bits, 16);
}

TEST(ImageFiles, RefusesWrongSizeAndKind) {
  const TempFolder folder;
  writeDepthImage(folder / "d.png", ramp(40, 30));
  EXPECT_NE(messageOf<DatasetError>([&] {
              readDepthImage(folder / "d.png", 640, 480);
            }).find("d.png: image size 40x30: must be 640x480"),
            std::string::npos);
  writeGreyImage(folder / "g.png", Image<std::uint8_t>(40, 30, 1));
  EXPECT_NE(messageOf<DatasetError>([&] {
              readDepthImage(folder / "g.png", 40, 30);
            }).find("1 channel(s) of 8 bit: must be 1 of 16 bit"),
            std::string::npos);
}

TEST(ImageFiles, RefusesDamagedFiles) {
  const TempFolder folder;
  writeDepthImage(folder / "d.png", ramp(40, 30));
  const std::string bytes = TempFolder::read(folder / "d.png");
  for (const std::size_t keep : {0UL, 5UL, 8UL, 20UL, 40UL, bytes.size() / 2, bytes.size() - 13}) {
    const std::string cut = folder.write("cut.png", bytes.substr(0, keep));
    EXPECT_THROW(readDepthImage(cut, 40, 30), DatasetError) << "kept " << keep;
  }
  for (std::size_t i = 0; i < bytes.size(); i += 3) {  // any damage: an error or an image, no harm
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x5a);
    try {
      readDepthImage(folder.write("damaged.png", damaged), 40, 30);
    } catch (const DatasetError&) {
    }
  }
  EXPECT_THROW(readDepthImage(folder.write("text.png", "no image at all"), 40, 30), DatasetError);
  EXPECT_THROW(readDepthImage(folder / "none.png", 40, 30), DatasetError);
  EXPECT_THROW(readDepthImage(folder.path(), 40, 30), DatasetError);
}

TEST(ImageFiles, HugeHeaderAllocatesNothing) {
  const TempFolder folder;
  writeDepthImage(folder / "d.png", ramp(1, 1));
  EXPECT_THROW(readDepthImage(folder / "d.png", 640, 480), DatasetError);
  std::string bytes = TempFolder::read(folder / "d.png");
  bytes[16] = 0x00;
  bytes[18] = static_cast<char>(0x9c);  // 40000 px wide
  bytes[19] = 0x40;
  EXPECT_NE(messageOf<DatasetError>([&] {
              readDepthImage(folder.write("huge.png", bytes), 640, 480);
            }).find("image size 40000x1"),
            std::string::npos);
  bytes[16] = static_cast<char>(0xff);  // beyond int
  EXPECT_NE(messageOf<DatasetError>([&] {
              readDepthImage(folder.write("huge.png", bytes), 640, 480);
            }).find("is no PNG or JPEG"),
            std::string::npos);
}

TEST(ImageFiles, DepthBecomesWholeMillimetres) {
  Image<std::uint16_t> raw(6, 1);
  raw[0] = 0;
  raw[1] = 5000;
  raw[2] = 5002;
  raw[3] = 5003;
  raw[4] = 1;
  raw[5] = 65535;
  const Image<std::uint16_t> mm = depthToMillimetres(raw, 5000);
  EXPECT_EQ(mm[0], 0);
  EXPECT_EQ(mm[1], 1000);
  EXPECT_EQ(mm[2], 1000);
  EXPECT_EQ(mm[3], 1001);
  EXPECT_EQ(mm[4], 1) << "a measurement never becomes a hole";
  EXPECT_EQ(mm[5], 13107);
  EXPECT_EQ(depthToMillimetres(raw, 100)[5], 65535) << "saturates";
  EXPECT_THROW(depthToMillimetres(raw, 0), std::invalid_argument);
}

}  // namespace
}  // namespace rf
