// SPDX-License-Identifier: BSD-3-Clause
// Which source gives which prior.
#include "pipeline/run_options.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "../datasets/temp_folder.hpp"

namespace rf {
namespace {

class RobotOption : public testing::Test {
 protected:
  RobotOption() {
    options_.input = folder_.path();
    options_.output = folder_ / "out";
    folder_.write("odometry.txt", "");
    folder_.write("object_odometry.txt", "");
  }
  void addRobot() { std::filesystem::create_directories(folder_ / "robot"); }
  TempFolder folder_;
  RunOptions options_;
};

TEST_F(RobotOption, WithoutARobotFilesAreTaken) {
  EXPECT_EQ(options_.robotFolder(), "");
  EXPECT_FALSE(options_.robotGivesCamera());
  EXPECT_EQ(options_.cameraPriorFile(), folder_ / "odometry.txt");
  EXPECT_EQ(options_.objectPriorFile(), folder_ / "object_odometry.txt");
}

TEST_F(RobotOption, RobotOfTheInputWinsOverItsFiles) {
  addRobot();
  EXPECT_EQ(options_.robotFolder(), folder_ / "robot");
  EXPECT_TRUE(options_.robotGivesCamera());
  EXPECT_TRUE(options_.robotGivesObject());
  EXPECT_EQ(options_.cameraPriorFile(), "");
  EXPECT_EQ(options_.objectPriorFile(), "");
}

TEST_F(RobotOption, NoneLeavesItOut) {
  addRobot();
  options_.robot = "none";
  EXPECT_EQ(options_.robotFolder(), "");
  EXPECT_EQ(options_.cameraPriorFile(), folder_ / "odometry.txt");
}

TEST_F(RobotOption, NamedPriorsWin) {
  addRobot();
  options_.camera_prior = folder_ / "odometry.txt";
  options_.object_prior = "none";
  EXPECT_FALSE(options_.robotGivesCamera());
  EXPECT_FALSE(options_.robotGivesObject());
  EXPECT_EQ(options_.cameraPriorFile(), folder_ / "odometry.txt");
  EXPECT_EQ(options_.objectPriorFile(), "");
  EXPECT_EQ(options_.problem(), "");
}

TEST_F(RobotOption, ProblemsAreNamed) {
  options_.robot = folder_ / "nowhere";
  EXPECT_EQ(options_.problem(), "--robot = '" + (folder_ / "nowhere") + "': no such file");
  options_.robot.clear();
  addRobot();
  options_.simulate_drift = {0.06, 0.4};
  EXPECT_EQ(options_.problem(), "--simulate-drift: drifts prior files, but " + (folder_ / "robot") +
                                    " gives the camera's prior; give --camera-prior, or --robot "
                                    "none");
  options_.robot = "none";
  EXPECT_EQ(options_.problem(), "");
}

}  // namespace
}  // namespace rf
