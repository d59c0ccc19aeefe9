// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/trajectory.hpp"

#include <limits>

#include "datasets/error.hpp"
#include "datasets/text.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

TEST(Timestamp, IsExactToTheMicrosecond) {
  EXPECT_EQ(parseTimestamp("1305031232.868557"), 1305031232868557);
  EXPECT_EQ(parseTimestamp("1305031232.8686"), 1305031232868600);
  EXPECT_EQ(parseTimestamp("5"), 5000000);
  EXPECT_EQ(parseTimestamp(".5"), 500000);
  EXPECT_EQ(parseTimestamp("-0.25"), -250000);
  EXPECT_EQ(parseTimestamp("0.1234567"), 123457);
  EXPECT_EQ(parseTimestamp("1.305031232e+09"), 1305031232000000);
  for (const char* bad : {"", ".", "abc", "1.2.3", "nan", "inf", "1e300", "12345678901234567890"}) {
    EXPECT_FALSE(parseTimestamp(bad)) << bad;
  }
  for (const std::int64_t utime : {0L, 1L, -1L, 1305031232868557L, -250000L}) {
    EXPECT_EQ(parseTimestamp(formatTimestamp(utime)), utime);
  }
  EXPECT_EQ(formatTimestamp(1305031232000001), "1305031232.000001");
}

TEST(TrajectoryFile, WrittenPosesReadBack) {
  const TempFolder folder;
  const SE3 pose = SE3::exp((Vec6() << 1.5, -2.25, 0.125, 0.3, -0.2, 2.8).finished());
  {
    TrajectoryWriter writer(folder / "camera.txt", "T_WC");
    writer.add(1305031232868557, SE3());
    writer.add(1305031232900000, pose);
    EXPECT_NE(TempFolder::read(folder / "camera.txt").find("1305031232.900000 "), std::string::npos)
        << "a line is on disk as soon as it is added";
  }
  const Trajectory back = readTrajectory(folder / "camera.txt");
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].utime, 1305031232868557);
  EXPECT_EQ(back[1].utime, 1305031232900000);
  EXPECT_LT((back[1].pose.inverse() * pose).log().norm(), 5e-9);
}

TEST(TrajectoryFile, LineFormatIsFixed) {
  EXPECT_EQ(formatTumPose(1000000, SE3(Eigen::Quaterniond(1, 0, 0, 0), Vec3(-1e-12, 1.0 / 3, -2))),
            "1.000000 0.000000000 0.333333333 -2.000000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000");
}

TEST(TrajectoryFile, ReadsCommentsCommasAndFewDecimals) {
  const TempFolder folder;
  const std::string file =
      folder.write("t.txt", "# c\n\n1.0,0,0,0,-0.6602,-0.5532,-0.0601,0.5045\r\n  # d\n");
  const Trajectory t = readTrajectory(file);
  ASSERT_EQ(t.size(), 1U);
  EXPECT_NEAR(t[0].pose.q.norm(), 1.0, 1e-15);
}

std::string errorOf(const std::string& text) {
  const TempFolder folder;
  const std::string file = folder.write("t.txt", text);
  const std::string message = messageOf<DatasetError>([&] { readTrajectory(file); });
  return message.rfind(file, 0) == 0 ? message.substr(file.size()) : message;
}

TEST(TrajectoryFile, ErrorsNameLineValueAndRule) {
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(errorOf(good + "2 nan 0 0 0 0 0 1\n"), ":2: tx = nan: must be finite");
  EXPECT_EQ(errorOf(good + "2 0 inf 0 0 0 0 1\n"), ":2: ty = inf: must be finite");
  EXPECT_EQ(errorOf(good + "2 0 0 x 0 0 0 1\n"), ":2: tz = x: must be a number");
  EXPECT_EQ(errorOf("2 0 0 0 0 0 0 0.5\n"), ":1: quaternion length = 0.5: must be 1 within 0.01");
  EXPECT_EQ(errorOf("2 0 0 0 0 0 0 0\n"), ":1: quaternion length = 0: must be 1 within 0.01");
  EXPECT_EQ(errorOf(good + "#\n0.5 0 0 0 0 0 0 1\n"),
            ":3: timestamp = 0.5: must be later than 1.000000 of the line before");
  EXPECT_NE(errorOf(good + good).find(":2: timestamp = 1"), std::string::npos);
  EXPECT_NE(errorOf("1 0 0 0\n").find("4 words"), std::string::npos);
  EXPECT_EQ(errorOf("nan 0 0 0 0 0 0 1\n"), ":1: timestamp = nan: must be seconds");
  EXPECT_THROW(readTrajectory("/nonexistent/t.txt"), DatasetError);
}

TEST(TrajectoryFile, RefusesToWriteNaN) {
  const TempFolder folder;
  TrajectoryWriter writer(folder / "t.txt", "T");
  SE3 pose;
  pose.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writer.add(1, pose), DatasetError);
}

}  // namespace
}  // namespace rf
