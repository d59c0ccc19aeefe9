// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/ply.hpp"

#include "datasets/error.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

std::vector<SurfelPoint> somePoints() {
  std::vector<SurfelPoint> points(3);
  points[0] = {1, 2, 3, 0, 0, 1, 10, 20, 30, 0.01F, 0.5F};
  points[2] = {-1.5F, 0.25F, 7, 1, 0, 0, 255, 0, 7, 0.02F, 1.0F};
  return points;
}

TEST(Ply, RoundTrips) {
  const TempFolder folder;
  writePly(folder / "a.ply", somePoints());
  EXPECT_EQ(readPly(folder / "a.ply"), somePoints());
  EXPECT_NE(TempFolder::read(folder / "a.ply")
                .find("property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
                      "property uchar green\nproperty uchar blue\nproperty float nx\n"
                      "property float ny\nproperty float nz\nproperty float radius\n"
                      "property float confidence\nend_header\n"),
            std::string::npos);
  writePly(folder / "empty.ply", {});
  EXPECT_TRUE(readPly(folder / "empty.ply").empty());
}

TEST(Ply, ReadsAsciiAndForeignProperties) {
  const TempFolder folder;
  const std::string file = folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\ncomment c\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty int quality\nproperty uchar red\nelement face 0\n"
      "property list uchar int vertex_indices\nend_header\n1 2 3 9 200\n4 5 6 9 100\n");
  const std::vector<SurfelPoint> points = readPly(file);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].x, 4);
  EXPECT_EQ(points[1].red, 100);
}

TEST(Ply, RefusesDamage) {
  const TempFolder folder;
  writePly(folder / "a.ply", somePoints());
  const std::string bytes = TempFolder::read(folder / "a.ply");
  for (std::size_t keep = 0; keep < bytes.size(); keep += 7) {
    EXPECT_THROW(readPly(folder.write("cut.ply", bytes.substr(0, keep))), DatasetError) << keep;
  }
  std::string huge = bytes;
  huge.replace(huge.find("vertex 3"), 8, "vertex 99999999999999");
  EXPECT_NE(messageOf<DatasetError>([&] {
              readPly(folder.write("huge.ply", huge));
            }).find("do not fit the file"),
            std::string::npos);
  const std::string nan =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\nnan 0 0\n";
  EXPECT_THROW(readPly(folder.write("nan.ply", nan)), DatasetError);
  EXPECT_THROW(readPly(folder / "none.ply"), DatasetError);
}

}  // namespace
}  // namespace rf
