// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/settling.hpp"

#include <string>

#include <gtest/gtest.h>

namespace rf {
namespace {

// Frames as m (moves) and r (rests); the answer after each: d (in doubt) or a dot.
std::string doubts(int frames, const std::string& sequence) {
  Settling settling(frames);
  std::string out;
  for (const char c : sequence) {
    settling.note(c == 'm');
    out += settling.inDoubt() ? 'd' : '.';
  }
  return out;
}

TEST(Settling, ABodyRestsAfterAWindowOfRest) {
  EXPECT_EQ(doubts(3, "rrmmmmmrrrrr"), ".......ddd..");
}

TEST(Settling, AFalseAlarmStaysAsShortAsItIs) {
  EXPECT_EQ(doubts(3, "rrrrmmrrrr"), "..........");
  EXPECT_EQ(doubts(3, "mrrrrmrrrrmrrrr"), "...............");
}

TEST(Settling, APauseWithinMotionIsBridged) {
  EXPECT_EQ(doubts(3, "mmmmrmrrmrrr"), "....d.dd.ddd");
}

TEST(Settling, ZeroFramesAreNone) { EXPECT_EQ(doubts(0, "mmmmrrr"), "......."); }

}  // namespace
}  // namespace rf
