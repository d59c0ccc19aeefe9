// SPDX-License-Identifier: BSD-3-Clause
// What goes wrong in the field: a clear message or a counted drop, and the pipeline goes on.
#include <cmath>
#include <fstream>

#include "datasets/image_files.hpp"
#include "messaging/log_file.hpp"
#include "messaging/net_check.hpp"
#include "pipeline_fixture.hpp"
#include "robot_folder.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;
using Fault = PipelineTest;

testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "no '" << part << "' in:\n" << text;
}

/// rf-run on a folder; every frame must be in camera.txt or listed as lost.
struct OfflineRun {
  int code = -1;
  std::size_t poses = 0;
  std::string said, frames_csv;
};

class OfflineFault : public PipelineTest {
 protected:
  std::string copyOfCut() {
    const std::string to = own("cut");
    fs::copy(shared("cut"), to, fs::copy_options::recursive);
    return to;
  }
  OfflineRun runOn(const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"--input", input, "--output", own("result")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    OfflineRun out;
    out.code = run("rf-run", arguments, own("said.txt"));
    out.poses = linesOf(own("result/camera.txt")).size();
    out.said = contentOf(own("said.txt"));
    out.frames_csv = contentOf(own("result/frames.csv"));
    return out;
  }
  std::string nthDepth(int n) {
    const std::string line = linesOf(shared("cut/depth.txt")).at(static_cast<std::size_t>(n));
    return line.substr(line.find(' ') + 1);
  }
};

TEST_F(OfflineFault, MissingTruncatedAndWrongSizeImagesAreListedAsLost) {
  const std::string cut = copyOfCut();
  fs::remove(cut + "/" + nthDepth(3));
  fs::resize_file(cut + "/" + nthDepth(5), 1000);
  writeDepthImage(cut + "/" + nthDepth(7), Image<std::uint16_t>(16, 12));
  const OfflineRun out = runOn(cut);
  EXPECT_EQ(out.code, 0) << out.said;
  EXPECT_EQ(out.poses, static_cast<std::size_t>(kFrames - 3));
  for (const int n : {3, 5, 7}) EXPECT_TRUE(says(out.said, nthDepth(n)));
  EXPECT_TRUE(says(out.frames_csv, "lost"));
}

TEST_F(OfflineFault, PriorIsMissing) {
  const OfflineRun out = runOn(shared("cut"), {"--camera-prior", "none"});
  EXPECT_EQ(out.code, 0) << out.said;
  EXPECT_EQ(out.poses, static_cast<std::size_t>(kFrames));
}

TEST_F(OfflineFault, PriorThatEndsEarlyIsFlaggedNotInvented) {
  const std::string cut = copyOfCut();
  std::ofstream(cut + "/odometry.txt") << linesOf(shared("cut/groundtruth.txt")).front() << "\n";
  const OfflineRun out = runOn(cut);
  EXPECT_EQ(out.code, 0) << out.said;
  EXPECT_EQ(out.poses, static_cast<std::size_t>(kFrames));
}

TEST_F(OfflineFault, NaNInAPoseNamesFileAndLine) {
  const std::string cut = copyOfCut();
  std::ofstream(cut + "/odometry.txt", std::ios::app) << "1305031299.0 nan 0 0 0 0 0 1\n";
  const OfflineRun out = runOn(cut);
  EXPECT_NE(out.code, 0);
  EXPECT_TRUE(says(out.said, "odometry.txt"));
  EXPECT_TRUE(says(out.said, "nan"));
}

TEST_F(OfflineFault, RobotFaultsAreNamedOrFlagged) {
  const std::string robot = own("robot");
  const std::vector<std::string> poses = linesOf(shared("cut/groundtruth.txt"));
  writeRobotFolder(robot, poses);
  const auto runRobot = [&] { return runOn(shared("cut"), {"--robot", robot}); };
  // A joint that goes by another name: said, flagged, and every frame has its result.
  std::string joints = contentOf(robot + "/joints.csv");
  std::ofstream(robot + "/joints.csv") << "timestamp,Pan" << joints.substr(joints.find(",lift"));
  OfflineRun out = runRobot();
  EXPECT_EQ(out.code, 0) << out.said;
  EXPECT_EQ(out.poses, static_cast<std::size_t>(kFrames));
  EXPECT_TRUE(says(out.said, "joint 'pan' has no samples: camera priors are missing"));
  // NaN in a file is named with its line.
  std::ofstream(robot + "/joints.csv") << "timestamp,pan,lift\n1,nan,0\n";
  out = runRobot();
  EXPECT_EQ(out.code, 4);
  EXPECT_TRUE(says(out.said, "joints.csv:2: pan = nan: must be finite"));
  // Odometry that jumps: said, and the pipeline goes on.
  writeRobotFolder(robot, poses);
  std::ofstream(robot + "/odometry.txt", std::ios::app) << "1405031299.0 9 9 9 0 0 0 1\n"
                                                        << "1405031299.1 99 9 9 0 0 0 1\n";
  out = runRobot();
  EXPECT_EQ(out.code, 0) << out.said;
  EXPECT_TRUE(says(out.said, "odometry jumps by 90.000 m in 0.100 s (max_speed is 3 m/s)"));
  // A URDF that is none, and a link that it does not have.
  std::ofstream(robot + "/robot.urdf") << "<robot name='x'><link name='a'/>";
  out = runRobot();
  EXPECT_EQ(out.code, 2);
  EXPECT_TRUE(says(out.said, "robot.urdf: not a usable URDF"));
  writeRobotFolder(robot, poses);
  out = runOn(shared("cut"), {"--robot", robot, "--set", "prior.robot.camera_link=head"});
  EXPECT_EQ(out.code, 2);
  EXPECT_TRUE(says(out.said, "link 'head': there is no such link"));
}

TEST_F(Fault, GarbageOnEveryChannelIsCountedAndTheResultUnchanged) {
  start("prior",
        {"--lockstep", "--camera", shared("cut/odometry.txt"), "--simulate-drift", "0.06,0.4"});
  start("segment", {"--lockstep"});
  start("fuse", {"--lockstep", "--write-masks", "--output", own("result")});
  Watch watch(kState);
  awaitReady(watch);
  {
    Bus bulk("", kBulk), state("", kState);
    const std::vector<std::uint8_t> garbage(300, 0xA5);
    EXPECT_EQ(bulk.publish("OPENNI_FRAME", garbage), "");
    for (const char* channel : {"RF_CAMERA", "RF_FRAME_TICK", "RF_MOTION_PRIOR", "RF_SEGMENTATION",
                                "RF_MODEL_STATE", "RF_COMMAND"}) {
      EXPECT_EQ(state.publish(channel, garbage), "") << channel;
    }
  }
  EXPECT_EQ(run("rf-capture",
                {"--bulk-in", kBulk, "--state-in", kState, "--lockstep", "--input", shared("cut"),
                 "--await", "prior,segment,fuse"},
                own("rf-capture.txt")),
            0)
      << contentOf(own("rf-capture.txt"));
  stopAll();
  expectSameAsOffline(own("result"));
  // One a channel that the service listens to; the first is explained, the others within the same
  // second only counted.
  for (const auto& [name, bad] :
       {std::pair("prior", " 2 bad"), {"segment", " 5 bad"}, {"fuse", " 5 bad"}}) {
    EXPECT_TRUE(says(logOf(name), "its hash is a5a5a5a5a5a5a5a5"));
    EXPECT_TRUE(says(logOf(name), bad));
  }
}

TEST_F(Fault, MessageAboveTheGrantedBufferIsRefusedWithTheSysctl) {
  Bus bus("", kBulk);
  const auto granted = static_cast<std::size_t>(grantedReceiveBuffer(1L << 30));
  ASSERT_LT(granted, std::size_t{1} << 30);
  const std::string why = bus.publish("OPENNI_FRAME", std::vector<std::uint8_t>(granted + 1));
  EXPECT_TRUE(says(why, "rmem_max"));
  EXPECT_EQ(bus.publish("OPENNI_FRAME", std::vector<std::uint8_t>(1000)), "");
}

TEST_F(Fault, TruncatedLogReplaysWhatItHas) {
  const std::string log = own("truncated.lcm");
  fs::copy_file(shared("launched/recording.lcm"), log);
  fs::resize_file(log, fs::file_size(log) * 7 / 10);
  EXPECT_EQ(replay(log), 0) << contentOf(own("rf-replay.txt"));
  EXPECT_TRUE(says(contentOf(own("rf-replay.txt")), "truncated"));
  const std::size_t poses = linesOf(own("result/camera.txt")).size();
  EXPECT_GE(poses, 1U);
  EXPECT_LE(poses, static_cast<std::size_t>(kFrames));
}

TEST_F(Fault, LostFramesAreCountedAndTheRestGoesOn) {
  LogReader reader(shared("launched/recording.lcm"));
  const std::string log = own("lossy.lcm");
  int frames = 0;
  {
    LogWriter writer(log);
    while (const auto event = reader.next()) {
      if (event->channel == "OPENNI_FRAME" && (++frames == 4 || frames == 5)) continue;
      writer.write(event->utime, event->channel, event->data);
    }
    writer.flush();
  }
  ASSERT_EQ(frames, kFrames);
  EXPECT_EQ(replay(log), 0) << contentOf(own("rf-replay.txt"));
  EXPECT_EQ(linesOf(own("result/camera.txt")).size(), static_cast<std::size_t>(kFrames - 2));
  std::size_t listed = 0;
  for (const std::string& line : linesOf(own("result/frames.csv")))
    listed += line.find("no result") != std::string::npos ? 1 : 0;
  EXPECT_EQ(listed, 2U) << contentOf(own("result/frames.csv"));
}

}  // namespace
}  // namespace rf
