// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/robot_files.hpp"

#include <gtest/gtest.h>

#include "../kinematics/urdf_text.hpp"
#include "config/yaml.hpp"
#include "datasets/error.hpp"
#include "datasets/robot_folder.hpp"
#include "temp_folder.hpp"

namespace rf {
namespace {

class RobotFiles : public testing::Test {
 protected:
  template <class Reader>
  std::string refusal(const Reader& reader, const std::string& text) {
    const std::string path = folder_.write("x.csv", text);
    const std::string said = messageOf<DatasetError>([&] { reader(path); });
    EXPECT_EQ(said.rfind(path + ":", 0), 0U) << said;
    return said.substr(std::min(said.size(), path.size() + 1));
  }
  TempFolder folder_;
};

TEST_F(RobotFiles, JointsAreRead) {
  const JointTable table = readJoints(
      folder_.write("j.csv", "# made by hand\ntimestamp,pan,tilt\n1.5,0.1,-0.2\n1.51,0.2,1e-3\n"));
  EXPECT_EQ(table.joints, (std::vector<std::string>{"pan", "tilt"}));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0].utime, 1500000);
  EXPECT_EQ(table.rows[1].positions, (std::vector<double>{0.2, 1e-3}));
}

TEST_F(RobotFiles, BadJointsAreNamed) {
  const auto read = [this](const std::string& text) { return refusal(readJoints, text); };
  EXPECT_EQ(read(""), " has no header");
  EXPECT_EQ(read("timestamp\n"), " header names no joint");
  EXPECT_EQ(read("time,pan\n1,2\n"), "1: header begins with time: must be timestamp");
  EXPECT_EQ(read("timestamp,pan,pan\n"), "1: column pan comes twice");
  EXPECT_EQ(read("timestamp,pan\n1,0.1\n2\n"), "3: 1 columns: must be 2 as in the header");
  EXPECT_EQ(read("timestamp,pan,tilt\n1,,0.1\n"), "2: 2 columns: must be 3 as in the header");
  EXPECT_EQ(read("timestamp,pan\n1,x\n"), "2: pan = x: must be a number");
  EXPECT_EQ(read("timestamp,pan\n1,nan\n"), "2: pan = nan: must be finite");
  EXPECT_EQ(read("timestamp,pan\nx,1\n"), "2: timestamp = x: must be seconds");
  EXPECT_EQ(read("timestamp,pan\n2,1\n2,1\n"),
            "3: timestamp = 2: must be later than 2.000000 of the row before");
}

TEST_F(RobotFiles, TwistsAndGraspsAreRead) {
  const auto twists = readTwists(folder_.write("t.csv", "timestamp,vx,vy,wz\n1,0.5,0,-0.1\n"));
  ASSERT_EQ(twists.size(), 1U);
  EXPECT_EQ(twists[0].utime, 1000000);
  EXPECT_EQ(twists[0].twist.vx, 0.5);
  EXPECT_EQ(twists[0].twist.wz, -0.1);
  const auto grasps = readGrasps(folder_.write(
      "g.csv",
      "timestamp,held,tx,ty,tz,qx,qy,qz,qw\n1,1,0.1,0.2,0.3,0,0,0,1\n2,0,0,0,0,0,0,0,0\n"));
  ASSERT_EQ(grasps.size(), 2U);
  EXPECT_TRUE(grasps[0].held);
  EXPECT_EQ(grasps[0].T_GO.t, Vec3(0.1, 0.2, 0.3));
  EXPECT_FALSE(grasps[1].held);
}

TEST_F(RobotFiles, BadTwistsAndGraspsAreNamed) {
  EXPECT_EQ(refusal(readTwists, "timestamp,vx,wz\n"),
            " header is timestamp,vx,wz: must be timestamp,vx,vy,wz");
  EXPECT_EQ(refusal(readTwists, "timestamp,vx,vy,wz\n1,inf,0,0\n"), "2: vx = inf: must be finite");
  const std::string header = "timestamp,held,tx,ty,tz,qx,qy,qz,qw\n";
  EXPECT_EQ(refusal(readGrasps, header + "1,2,0,0,0,0,0,0,1\n"), "2: held = 2: must be 0 or 1");
  EXPECT_EQ(refusal(readGrasps, header + "1,1,0,0,0,0,0,0,2\n"),
            "2: quaternion length = 2: must be 1 within 0.01");
}

/// A folder as a recording has it: a second of a robot that drives straight.
void writeRobot(const TempFolder& folder) {
  folder.write("robot.urdf", urdfManipulator());
  folder.write("robot.yaml",
               "base_link: base\ncamera_link: camera\ngripper_link: gripper\nwheel_scale: 1.02\n");
  std::string twists = "timestamp,vx,vy,wz\n";
  std::string joints = "timestamp,pan,tilt,lift,elbow\n";
  for (int i = 0; i <= 100; ++i) {
    const std::string t = std::to_string(100 + i) + "e-2";
    twists += t + ",0.5,0,0\n";
    joints += t + ",0.1,0.2,0.3,0.4\n";
  }
  folder.write("twist.csv", twists);
  folder.write("joints.csv", joints);
  folder.write("grasp.csv", "timestamp,held,tx,ty,tz,qx,qy,qz,qw\n1.5,1,0.1,0,0,0,0,0,1\n");
}

TEST(RobotFolder, IsReadAsAWhole) {
  const TempFolder folder;
  writeRobot(folder);
  PriorConfig config;
  loadRobotConfig(folder.path(), config);
  EXPECT_EQ(config.robot.wheel_scale, 1.02);
  const RobotRecording recording = readRobot(folder.path(), config);
  EXPECT_EQ(recording.remarks, std::vector<std::string>{});
  MotionPrior prior;
  prior.utime_a = 1'600'000;
  prior.utime_b = 1'700'000;
  EXPECT_EQ(recording.robot.fillCamera(prior), "");
  EXPECT_NEAR(prior.T_CaCb.t.norm(), 0.1 * 0.5 * 1.02, 1e-9);
  EXPECT_EQ(recording.robot.fillObject(prior), "");
  EXPECT_EQ(prior.object, PriorState::kValid);
}

TEST(RobotFolder, WhatIsMissingOrOddIsRemarked) {
  const TempFolder folder;
  writeRobot(folder);
  std::filesystem::remove(folder / "twist.csv");
  folder.write("joints.csv", "timestamp,pan,Tilt,lift,elbow\n1,0,0,0,0\n1.01,9,0,0,0\n");
  PriorConfig config;
  loadRobotConfig(folder.path(), config);
  const auto remarks = readRobot(folder.path(), config).remarks;
  ASSERT_EQ(remarks.size(), 3U);
  EXPECT_EQ(remarks[0], folder / "joints.csv" +
                            ": sample at 1.010000: joint 'pan' jumps by 9.000 in 0.010 s "
                            "(max_joint_speed is 20 per s)");
  EXPECT_EQ(remarks[1], folder.path() +
                            ": no odometry: camera priors are missing (fixed_base says "
                            "that there is none)");
  EXPECT_EQ(remarks[2], folder.path() + ": joint 'tilt' has no samples: camera priors are missing");
}

TEST(RobotFolder, WhatCannotBeUsedIsRefused) {
  const TempFolder folder;
  writeRobot(folder);
  PriorConfig config;
  loadRobotConfig(folder.path(), config);
  folder.write("odometry.txt", "1 0 0 0 0 0 0 1\n");
  EXPECT_NE(messageOf<DatasetError>([&] {
              readRobot(folder.path(), config);
            }).find("only one may be there"),
            std::string::npos);
  folder.write("robot.urdf", "<robot");
  EXPECT_EQ(messageOf<KinematicsError>([&] {
              openRobot(folder.path(), config);
            }).rfind(folder / "robot.urdf" + ": not a usable URDF", 0),
            0U);
  std::filesystem::remove(folder / "robot.urdf");
  EXPECT_EQ(messageOf<DatasetError>([&] { openRobot(folder.path(), config); }),
            folder / "robot.urdf" + ": cannot be read");
  folder.write("robot.yaml", "camera_links: x\n");
  EXPECT_NE(
      messageOf<ConfigError>([&] { loadRobotConfig(folder.path(), config); }).find("camera_links"),
      std::string::npos);
}

}  // namespace
}  // namespace rf
