// SPDX-License-Identifier: BSD-3-Clause
// The same bytes however the pipeline is run: in one process, as five, from a recording.
#include "pipeline_fixture.hpp"

#include <cstdlib>
#include <regex>

#include "messaging/bus.hpp"
#include "messaging/log_file.hpp"

namespace rf {
namespace {

using Lockstep = PipelineTest;

TEST_F(Lockstep, FiveProcessesEqualOne) { expectSameAsOffline(shared("launched")); }

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
