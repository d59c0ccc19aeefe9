// SPDX-License-Identifier: BSD-3-Clause
// The same bytes however the pipeline is run: in one process, as five, from a recording.
#include "pipeline_fixture.hpp"

#include <cstdlib>
#include <map>
#include <regex>

#include "messaging/bus.hpp"
#include "messaging/conversions.hpp"
#include "messaging/log_file.hpp"
#include "robot_folder.hpp"

namespace rf {
namespace {

using Lockstep = PipelineTest;

TEST_F(Lockstep, FiveProcessesEqualOne) { expectSameAsOffline(shared("launched")); }

TEST_F(Lockstep, FiveProcessesEqualOneWithARobot) {
  const std::string robot = own("robot");
  writeRobotFolder(robot, linesOf(shared("cut/groundtruth.txt")));
  const std::vector<std::string> job = {"--input", shared("cut"), "--write-masks", "--robot",
                                        robot};
  auto offline = job, launched = job;
  offline.insert(offline.end(), {"--output", own("offline")});
  launched.insert(launched.end(), {"--output", own("launched"), "--port", "7713"});
  ASSERT_EQ(run("rf-run", offline, own("rf-run.txt")), 0) << contentOf(own("rf-run.txt"));
  ASSERT_EQ(run("rf-launch", launched, own("rf-launch.txt")), 0) << contentOf(own("rf-launch.txt"));
  EXPECT_EQ(linesOf(own("offline/camera_prior.txt")).size(), static_cast<std::size_t>(kFrames));
  expectSame(own("launched"), own("offline"));
  std::map<std::int64_t, MotionPrior> priors;  // by time: one that was sent again is the same
  LogReader reader(own("launched/recording.lcm"));
  while (const auto event = reader.next()) {
    if (event->channel != "RF_MOTION_PRIOR") continue;
    const auto prior = unpack<rigidfusion::motion_prior_t>(event->data);
    ASSERT_TRUE(prior) << prior.error;
    priors[prior->utime_b] = *prior;
  }
  EXPECT_EQ(priors.size(), static_cast<std::size_t>(kFrames));
  for (const auto& [utime, prior] : priors) {
    EXPECT_EQ(prior.camera, PriorState::kValid);
    EXPECT_EQ(prior.object_kind, ObjectPriorKind::kCameraFrame);
    EXPECT_EQ(prior.object, PriorState::kValid);
    EXPECT_EQ(prior.self.size(), 1U);
  }
}

TEST_F(Lockstep, ReplayEqualsOne) {
  EXPECT_EQ(replay(shared("launched/recording.lcm")), 0) << contentOf(own("rf-replay.txt"));
  expectSameAsOffline(own("result"));
}

TEST_F(Lockstep, StockLogplayerFeedsLiveServices) {
  // As recorded with rf-record --channels: results in the log would mix with those of the services.
  const std::string inputs = own("inputs.lcm");
  {
    const std::regex wanted("OPENNI_FRAME|RF_CAMERA|RF_FRAME_TICK|RF_MOTION_PRIOR");
    LogReader reader(shared("launched/recording.lcm"));
    LogWriter writer(inputs);
    while (const auto event = reader.next())
      if (std::regex_match(event->channel, wanted))
        writer.write(event->utime, event->channel, event->data);
    writer.flush();
  }
  start("segment", {}, true);
  start("fuse", {"--output", own("result")}, true);
  {
    Watch watch(kBulk);
    awaitReady(watch);
  }
  const std::string player = "lcm-logplayer --speed=1 --lcm-url='" + std::string(kBulk) + "' " +
                             inputs + " > " + own("player.txt") + " 2>&1";
  ASSERT_EQ(std::system(player.c_str()), 0) << contentOf(own("player.txt"));
  stopAll();
  EXPECT_FALSE(linesOf(own("result/camera.txt")).empty()) << logOf("fuse");
}

TEST_F(Lockstep, RecorderSplitsBySizeIntoWholeLogs) {
  start("record", {"--output", own("split.lcm"), "--split-mb", "1"}, true);
  {
    Watch watch(kBulk);
    awaitReady(watch);
  }
  const std::string player = "lcm-logplayer --speed=1 --lcm-url='" + std::string(kBulk) + "' " +
                             shared("launched/recording.lcm") + " > " + own("player.txt") + " 2>&1";
  ASSERT_EQ(std::system(player.c_str()), 0) << contentOf(own("player.txt"));
  stopAll();
  int files = 0, frames = 0;
  for (; std::filesystem::exists(own("split.0" + std::string(1, char('0' + files)) + ".lcm"));
       ++files) {
    LogReader reader(own("split.0" + std::string(1, char('0' + files)) + ".lcm"));
    while (const auto event = reader.next()) frames += event->channel == "OPENNI_FRAME" ? 1 : 0;
    EXPECT_EQ(reader.damages(), 0);
    EXPECT_FALSE(reader.truncated());
  }
  EXPECT_GE(files, 2) << logOf("record");
  // Stock multicast may lose a frame on a busy machine; splitting must not.
  EXPECT_GE(frames, kFrames - 2) << logOf("record");
}

}  // namespace
}  // namespace rf
