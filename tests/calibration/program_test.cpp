// SPDX-License-Identifier: BSD-3-Clause
// rf-calibrate as a process: what it writes, refuses, and how it ends.
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
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

// --- a robot folder ---

/// A base with a camera on a joint that tilts, 2 cm from where it truly is, and behind the camera a
/// chain of six joints that puts the gripper anywhere. A second camera sits on the gripper.
std::string urdf() {
  const auto joint = [](const char* name, const char* type, const char* parent, const char* child,
                        const char* rest) {
    return fmt::format(
        "<link name='{}'/><joint name='{}' type='{}'><parent link='{}'/><child link='{}'/>{}"
        "</joint>",
        child, name, type, parent, child, rest);
  };
  const char* limit = "<limit lower='-9' upper='9' effort='1' velocity='9'/>";
  const auto axis = [&](const char* xyz) { return fmt::format("<axis xyz='{}'/>{}", xyz, limit); };
  return "<robot name='r'><link name='base_link'/>" +
         joint("tilt", "revolute", "base_link", "head",
               ("<origin xyz='0.27 -0.08 0.9' rpy='0 0 0.1'/>" + axis("0 1 0")).c_str()) +
         joint("optical", "fixed", "head", "camera",
               "<origin rpy='-1.5707963268 0 -1.5707963268'/>") +
         joint("x", "prismatic", "camera", "l1", axis("1 0 0").c_str()) +
         joint("y", "prismatic", "l1", "l2", axis("0 1 0").c_str()) +
         joint("z", "prismatic", "l2", "l3", axis("0 0 1").c_str()) +
         joint("yaw", "continuous", "l3", "l4", axis("0 0 1").c_str()) +
         joint("pitch", "continuous", "l4", "l5", axis("0 1 0").c_str()) +
         joint("roll", "continuous", "l5", "gripper", axis("1 0 0").c_str()) +
         joint("wrist", "fixed", "gripper", "wrist_camera", "") + "</robot>";
}

void writeRobot(const TempFolder& folder) {
  folder.write("robot/robot.urdf", urdf());
  folder.write("robot/robot.yaml",
               "base_link: base_link\ncamera_link: camera\ngripper_link: gripper\n");
}

std::string seconds(std::int64_t utime) {
  return fmt::format("{:.6f}", 1e-6 * static_cast<double>(utime));
}

void writeTilt(const TempFolder& folder, const Trajectory& times, double last = 0.3) {
  folder.write("robot/joints.csv",
               fmt::format("timestamp,tilt\n{},0.3\n{},{}\n", seconds(times.front().utime),
                           seconds(times.back().utime), last));
}

/// joints.csv with the gripper at these poses behind the camera.
void writeChain(const TempFolder& folder, const Trajectory& poses) {
  std::string out = "timestamp,roll,pitch,yaw,x,y,z\n";
  for (const StampedPose& p : poses) {
    const Mat3 R = p.pose.R();
    out += fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", seconds(p.utime),
                       std::atan2(R(2, 1), R(2, 2)), -std::asin(R(2, 0)),
                       std::atan2(R(1, 0), R(0, 0)), p.pose.t.x(), p.pose.t.y(), p.pose.t.z());
  }
  folder.write("robot/joints.csv", out);
}

/// What a base that reports velocities would say: of each step, in its middle.
void writeTwists(const TempFolder& folder, const Trajectory& poses) {
  std::string out = "timestamp,vx,vy,wz\n";
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double dt = 1e-6 * static_cast<double>(poses[i].utime - poses[i - 1].utime);
    const Vec6 v = (poses[i - 1].pose.inverse() * poses[i].pose).log() / dt;
    out += fmt::format("{},{:.9f},{:.9f},{:.9f}\n",
                       seconds((poses[i].utime + poses[i - 1].utime) / 2), v[0], v[1], v[5]);
  }
  folder.write("robot/twist.csv", out);
}

/// The values of a calibration.yaml in the order of the file.
std::vector<double> valuesOf(const std::string& file) {
  std::istringstream lines(text(file));
  std::vector<double> out;
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find(": ");
    if (!line.starts_with('#') && at != std::string::npos) {
      out.push_back(std::stod(line.substr(at + 2)));
    }
  }
  return out;
}

/// Distance (m) and angle (rad) of the first seven values from a transform.
std::pair<double, double> distanceTo(const SE3& truth, const std::vector<double>& v) {
  const SE3 found(Eigen::Quaterniond(v[6], v[3], v[4], v[5]), Vec3(v[0], v[1], v[2]));
  const Vec6 e = (truth.inverse() * found).log();
  return {e.head<3>().norm(), e.tail<3>().norm()};
}

std::string robotArguments(const TempFolder& folder, const std::string& problem,
                           const Trajectory& seen) {
  return problem + " --robot " + (folder / "robot") +
         (problem == "grasp" ? " --object " : " --camera ") + save(folder, "seen.txt", seen) +
         " --output " + (folder / "out");
}

TEST(RfCalibrateRobot, OdometryIsReadAsPosesOrAsTwists) {
  const TempFolder folder;
  const Recording r = simulateDrive(Drive::kLively, kDriven, 40, DriveNoise(), 1);
  writeRobot(folder);
  writeTilt(folder, r.A);
  save(folder, "robot/odometry.txt", r.A);
  const std::string line = robotArguments(folder, "odometry", r.X);
  ASSERT_EQ(run(folder, line), 0) << text(folder / "stderr");
  EXPECT_THAT(text(folder / "out/report.md"),
              HasSubstr("the prior of the transform is the URDF's"));
  const std::vector<double> by_poses = valuesOf(folder / "out/calibration.yaml");
  ASSERT_EQ(by_poses.size(), 10U);
  EXPECT_LT(distanceTo(kDriven.T_AX, by_poses).first, 0.01) << "the URDF is 2 cm off";
  EXPECT_NEAR(by_poses[7], kDriven.time_offset, 0.005);
  EXPECT_NEAR(by_poses[8], kDriven.translation_scale, 0.01);

  writeTwists(folder, r.A);
  EXPECT_EQ(run(folder, line), 4);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("twist.csv: only one may be there"));
  std::filesystem::remove(folder / "robot/odometry.txt");
  ASSERT_EQ(run(folder, line), 0) << text(folder / "stderr");
  const std::vector<double> by_twists = valuesOf(folder / "out/calibration.yaml");
  ASSERT_EQ(by_twists.size(), 10U);
  for (const std::size_t k : {0, 1, 2}) EXPECT_NEAR(by_twists[k], by_poses[k], 0.003) << k;
  EXPECT_NEAR(by_twists[7], by_poses[7], 0.003);
  EXPECT_NEAR(by_twists[8], by_poses[8], 0.003);
}

TEST(RfCalibrateRobot, GraspIsFittedWhileTheObjectIsHeld) {
  const TempFolder folder;
  const CalibrationValues truth{someGrip(), -0.037, 1, 1};
  Recording r = simulateGrasp(truth, 30, 0.0005, 0.002, 0.001, 1);
  writeRobot(folder);
  writeChain(folder, r.A);
  // Not held in the first third: there the object stands somewhere.
  const std::int64_t grasped = r.X.front().utime + 10'000'000;
  for (StampedPose& p : r.X) {
    if (p.utime < grasped) p.pose = SE3(Eigen::Quaterniond::Identity(), Vec3(1, 0, 2));
  }
  folder.write("robot/grasp.csv",
               fmt::format("timestamp,held,tx,ty,tz,qx,qy,qz,qw\n{},0,0,0,0,0,0,0,1\n"
                           "{},1,0,0,0,0,0,0,1\n",
                           seconds(r.A.front().utime), seconds(grasped + 100'000)));
  ASSERT_EQ(run(folder, robotArguments(folder, "grasp", r.X)), 0) << text(folder / "stderr");
  EXPECT_THAT(text(folder / "out/report.md"),
              HasSubstr("of 901 object poses are of times at which it is held"));
  const std::vector<double> found = valuesOf(folder / "out/calibration.yaml");
  ASSERT_EQ(found.size(), 8U);
  EXPECT_LT(distanceTo(truth.T_AX, found).first, 0.004);
  EXPECT_LT(distanceTo(truth.T_AX, found).second, 0.01);
  EXPECT_NEAR(found[7], truth.time_offset, 0.004);
}

TEST(RfCalibrateRobot, PosesThatAreNotTrackedAreNoMeasurement) {
  const TempFolder folder;
  const Recording r = simulateGrasp({someGrip(), 0, 1, 1}, 10, 0, 0.001, 0.001, 1);
  writeRobot(folder);
  writeChain(folder, r.A);
  std::filesystem::create_directories(folder / "result");
  Trajectory still = r.X;
  for (StampedPose& p : still) p.pose = SE3();
  save(folder, "result/object.txt", r.X);
  save(folder, "result/camera.txt", still);
  const auto states = [&](const char* health) {
    std::string out =
        "timestamp,body,health,c00,c01,c02,c03,c04,c05,c11,c12,c13,c14,c15,c22,c23,c24,c25,c33,"
        "c34,c35,c44,c45,c55\n";
    for (const StampedPose& p : r.X) {
      out +=
          seconds(p.utime) + ",object," + health + ",1,0,0,0,0,0,1,0,0,0,0,1,0,0,0,1,0,0,1,0,1\n";
    }
    folder.write("result/covariance.csv", out);
  };
  const std::string line = "grasp --robot " + (folder / "robot") + " --object " +
                           (folder / "result") + " --output " + (folder / "out");
  states("degraded");
  EXPECT_EQ(run(folder, line), 4);
  EXPECT_THAT(text(folder / "stderr"), HasSubstr("object.txt: none of 301 poses is tracked"));
  states("tracked");
  EXPECT_EQ(run(folder, line), 0) << text(folder / "stderr");
}

TEST(RfCalibrateRobot, HandEyeFollowsTheJoints) {
  const TempFolder folder;
  const CalibrationValues truth{someGrip(), 0.03, 1, 1};
  const Recording r = simulateArm(Reach::kFree, truth, 30, 0.0005, DriveNoise(), 1);
  writeRobot(folder);
  // The arm stands on what is the camera in the other tests.
  folder.write("robot/robot.yaml",
               "base_link: camera\ncamera_link: wrist_camera\ngripper_link: gripper\n");
  writeChain(folder, r.A);
  const std::string arguments = robotArguments(folder, "hand-eye", r.X);
  ASSERT_EQ(run(folder, arguments), 0) << text(folder / "stderr");
  const std::vector<double> found = valuesOf(folder / "out/calibration.yaml");
  ASSERT_EQ(found.size(), 8U);
  EXPECT_LT(distanceTo(truth.T_AX, found).first, 0.01);
  EXPECT_LT(distanceTo(truth.T_AX, found).second, 0.01);
  EXPECT_NEAR(found[7], truth.time_offset, 0.004);
}

/// Exit code 4, and what is said.
void expectUnusable(const TempFolder& folder, const std::string& line, const std::string& said) {
  EXPECT_EQ(run(folder, line), 4) << said;
  EXPECT_THAT(text(folder / "stderr"), HasSubstr(said));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/calibration.yaml"));
}

TEST(RfCalibrateRobot, NamesWhatIsWrongWithBaseAndCamera) {
  const TempFolder folder;
  const Recording r = simulateDrive(Drive::kLively, kDriven, 10, DriveNoise(), 1);
  writeRobot(folder);
  const std::string line = robotArguments(folder, "odometry", r.X);
  expectUnusable(folder, line, "odometry.txt");
  writeTwists(folder, r.A);
  expectUnusable(folder, line,
                 "joints.csv: is missing, but the pose of camera in base_link depends on joint "
                 "tilt");
  folder.write("robot/joints.csv", "timestamp,tilt\n");
  expectUnusable(folder, line, "joints.csv: has no row, but");
  folder.write("robot/joints.csv", "timestamp,pan\n1000,0.1\n");
  expectUnusable(folder, line, "joints.csv: column tilt is missing");
  folder.write("robot/joints.csv", "timestamp,tilt\n1000,nan\n");
  expectUnusable(folder, line, "joints.csv:2: tilt = nan: must be finite");
  writeTilt(folder, r.A, 0.32);
  expectUnusable(folder, line,
                 "joints.csv: tilt moves by 0.0200 between base_link and camera: must stay still");
  writeTilt(folder, r.A);
  folder.write("robot/twist.csv", "timestamp,vx,vy,wz\n1000,0.1,0,inf\n");
  expectUnusable(folder, line, "twist.csv:2: wz = inf: must be finite");
  folder.write("robot/twist.csv", "timestamp,vx,vy,wz\n");
  expectUnusable(folder, line, "odometry: 0 poses: must be at least 2");
  folder.write("robot/robot.yaml", "camera_link: nowhere\n");
  expectUnusable(folder, line, "nowhere");
  std::filesystem::remove(folder / "robot/robot.urdf");
  expectUnusable(folder, line, "robot.urdf: must be a readable URDF");
}

TEST(RfCalibrateRobot, NamesWhatIsWrongWithTheGrasp) {
  const TempFolder folder;
  const CalibrationValues truth{someGrip(), 0, 1, 1};
  const Recording r = simulateGrasp(truth, 10, 0, 0.001, 0.001, 1);
  writeRobot(folder);
  const std::string line = robotArguments(folder, "grasp", r.X);
  expectUnusable(folder, line, "joints.csv: is missing, but the pose of gripper in camera");
  writeChain(folder, r.A);
  const std::string header = "timestamp,held,tx,ty,tz,qx,qy,qz,qw\n";
  folder.write("robot/grasp.csv", "");
  expectUnusable(folder, line, "grasp.csv: has no header");
  folder.write("robot/grasp.csv", header);
  expectUnusable(folder, line, "grasp.csv: no row has held = 1");
  folder.write("robot/grasp.csv", header + "1000,0,0,0,0,0,0,0,1\n");
  expectUnusable(folder, line, "grasp.csv: no row has held = 1");
  folder.write("robot/grasp.csv", header + "1000,1,0,nan,0,0,0,0,1\n");
  expectUnusable(folder, line, "grasp.csv:2: ty = nan: must be finite");
  folder.write("robot/grasp.csv", header + "5000,1,0,0,0,0,0,0,1\n");
  expectUnusable(folder, line, "object poses are of times at which it is held");
  folder.write("robot/robot.yaml", "camera_link: camera\n");
  expectUnusable(folder, line, "robot.yaml: gripper_link is not given");
}

}  // namespace
}  // namespace rf::calibration
