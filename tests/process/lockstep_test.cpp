// SPDX-License-Identifier: BSD-3-Clause
// The same bytes however the pipeline is run: in one process, as five, from a recording.
#include "pipeline_fixture.hpp"

#include "messaging/bus.hpp"

namespace rf {
namespace {

using Lockstep = PipelineTest;

TEST_F(Lockstep, FiveProcessesEqualOne) { expectSameAsOffline(shared("launched")); }

TEST_F(Lockstep, ReplayEqualsOne) {
  EXPECT_EQ(replay(shared("launched/recording.lcm")), 0) << contentOf(own("rf-replay.txt"));
  expectSameAsOffline(own("result"));
}

TEST_F(Lockstep, StockLogplayerFeedsLiveServices) {
  start("segment", {}, true);
  start("fuse", {"--output", own("result")}, true);
  {
    Watch watch(kBulk);
    awaitReady(watch);
  }
  const std::string player = "lcm-logplayer --speed=1 --lcm-url='" + std::string(kBulk) + "' " +
                             shared("launched/recording.lcm") + " > " + own("player.txt") + " 2>&1";
  // The recording holds results of its own too; what counts is that live services take the frames.
  ASSERT_EQ(std::system(player.c_str()), 0) << contentOf(own("player.txt"));
  stopAll();
  EXPECT_FALSE(linesOf(own("result/camera.txt")).empty()) << logOf("fuse");
}

}  // namespace
}  // namespace rf
