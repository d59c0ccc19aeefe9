// SPDX-License-Identifier: BSD-3-Clause
// rf-calibrate as a process: what it writes, refuses, and how it ends.
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../datasets/temp_folder.hpp"
#include "datasets/trajectory.hpp"
#include "simulated_motion.hpp"

namespace rf::calibration {
namespace {

using namespace testing;
using ::testing::HasSubstr;

const CalibrationValues kDriven{someCamera(), 0.043, 1.03, 1};
constexpr const char* kPrior = " --extrinsic 0.27,-0.05,0.93,-0.59811,0.52500,-0.39944,0.45506";

std::string text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  return all.str();
}

std::string save(const TempFolder& folder, const std::string& name, const Trajectory& poses) {
  TrajectoryWriter writer(folder / name, name);
  for (const StampedPose& p : poses) writer.add(p.utime, p.pose);
  return folder / name;
}

/// Exit code; what it said is in the folder's stderr.
int run(const TempFolder& folder, const std::string& arguments) {
  const std::string command = std::string(RF_BIN_DIR) + "/rf-calibrate " + arguments + " >" +
                              (folder / "stdout") + " 2>" + (folder / "stderr");
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

std::string odometryArguments(const TempFolder& folder, Drive drive, double seconds) {
  const Recording r = simulateDrive(drive, kDriven, seconds, DriveNoise(), 1);
  return "odometry --odometry " + save(folder, "wheels.txt", r.A) + " --camera " +
         save(folder, "camera.txt", r.X) + " --output " + (folder / "out");
}

TEST(RfCalibrate, WritesAllResults) {
  const TempFolder folder;
  ASSERT_EQ(run(folder, odometryArguments(folder, Drive::kLively, 40) + kPrior), 0)
      << text(folder / "stderr");
  EXPECT_THAT(text(folder / "out/report.md"), HasSubstr("What the motion does not show"));
  EXPECT_THAT(text(folder / "out/calibration.yaml"), HasSubstr("base_to_camera:"));
  EXPECT_THAT(text(folder / "out/covariance.csv"), HasSubstr("parameter,vx,vy,vz,wx"));
  EXPECT_THAT(text(folder / "out/residuals.csv"), HasSubstr("held_out"));
  EXPECT_THAT(text(folder / "out/residuals.png"), HasSubstr("PNG"));
}

TEST(RfCalibrate, RefusesWhatTheMotionDoesNotShow) {
  const TempFolder folder;
  const std::string line = odometryArguments(folder, Drive::kStraight, 30) + kPrior;
  EXPECT_EQ(run(folder, line), 5);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("at least 30 are needed"));
  EXPECT_THAT(text(folder / "out/report.md"), HasSubstr("**Refused.**"));
  EXPECT_EQ(text(folder / "out/calibration.yaml"), "") << "no values without ground";
  EXPECT_EQ(run(folder, line + " --estimate rotation,time,scale"), 0) << text(folder / "stderr");
}

TEST(RfCalibrate, WithoutAPriorTheHeightIsRefused) {
  const TempFolder folder;
  EXPECT_EQ(run(folder, odometryArguments(folder, Drive::kLively, 40)), 5);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("z (height) of the camera"));
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("no prior is given"));
}

TEST(RfCalibrate, NamesWhatIsWrongWithItsInput) {
  const TempFolder folder;
  const std::string good = odometryArguments(folder, Drive::kLively, 10);
  folder.write("wheels.txt", "1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n");
  EXPECT_EQ(run(folder, good), 4);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("wheels.txt:2: tx = nan: must be finite"));
  folder.write("wheels.txt", "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(run(folder, good), 4);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("wheels.txt:2: timestamp = 1: must be later"));
  EXPECT_EQ(run(folder, good + " --odometry nowhere.txt"), 2) << "given twice";
}

TEST(RfCalibrate, BadOptionsAreNamed) {
  const TempFolder folder;
  EXPECT_EQ(run(folder, "--help"), 0);
  EXPECT_EQ(run(folder, ""), 2);
  EXPECT_EQ(run(folder, "odometry"), 2);
  const std::string good = odometryArguments(folder, Drive::kLively, 10);
  EXPECT_EQ(run(folder, good + " --estimate everything"), 2);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("--estimate everything: must be translation"));
  EXPECT_EQ(run(folder, good + " --extrinsic 1,2,3,0,0,0,0.5"), 2);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("--extrinsic: quaternion length"));
}

}  // namespace
}  // namespace rf::calibration
