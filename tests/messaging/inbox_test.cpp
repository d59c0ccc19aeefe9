// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/inbox.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "messaging/bus.hpp"
#include "messaging/net_check.hpp"

namespace rf {
namespace {

using std::chrono::milliseconds;

RawMessage message(std::uint8_t value) { return {"X", {value}, {}}; }

TEST(Inbox, OverflowDropsTheOldestAndCounts) {
  Inbox inbox;
  const auto box = inbox.addBox(3);
  for (std::uint8_t i = 0; i < 10; ++i) inbox.push(box, message(i));
  EXPECT_EQ(inbox.dropped(), 7);
  EXPECT_EQ(inbox.depth(), 3U);
  for (std::uint8_t i = 7; i < 10; ++i) EXPECT_EQ(inbox.pop(box)->bytes[0], i);
  EXPECT_FALSE(inbox.pop(box));
}

TEST(Inbox, SupersededHeartbeatsAreNoDrops) {
  Inbox inbox;
  const auto box = inbox.addBox(2, Overflow::kSupersede);
  for (std::uint8_t i = 0; i < 9; ++i) inbox.push(box, message(i));
  EXPECT_EQ(inbox.dropped(), 0);
  EXPECT_EQ(inbox.pop(box)->bytes[0], 7);
  EXPECT_EQ(inbox.pop(box)->bytes[0], 8);
}

TEST(Inbox, BoxesDoNotDisplaceEachOther) {
  Inbox inbox;
  const auto images = inbox.addBox(1);
  const auto commands = inbox.addBox(5);
  inbox.push(commands, message(1));
  for (std::uint8_t i = 0; i < 9; ++i) inbox.push(images, message(i));
  EXPECT_EQ(inbox.pop(commands)->bytes[0], 1);
  EXPECT_EQ(inbox.pop(images)->bytes[0], 8);
}

TEST(Inbox, WaitReportsEachArrivalOnce) {
  Inbox inbox;
  const auto box = inbox.addBox(3);
  EXPECT_FALSE(inbox.waitForNews(milliseconds(1)));
  inbox.push(box, message(1));
  EXPECT_TRUE(inbox.waitForNews(milliseconds(1)));
  EXPECT_FALSE(inbox.waitForNews(milliseconds(1)));
}

TEST(Inbox, FileInputWaitsForRoomAndLosesNothing) {
  Inbox inbox;
  const auto box = inbox.addBox(2, Overflow::kWait);
  std::thread reader([&] {
    for (std::uint8_t i = 0; i < 100; ++i) inbox.push(box, message(i));
  });
  for (std::uint8_t expected = 0; expected < 100;) {
    if (const auto m = inbox.pop(box)) {
      EXPECT_EQ(m->bytes[0], expected++);
    } else {
      inbox.waitForNews(milliseconds(10));
    }
  }
  reader.join();
  EXPECT_EQ(inbox.dropped(), 0);
}

TEST(Inbox, CloseFreesAWaitingReader) {
  Inbox inbox;
  const auto box = inbox.addBox(1, Overflow::kWait);
  std::thread reader([&] {
    inbox.push(box, message(1));
    inbox.push(box, message(2));
  });
  inbox.close();
  reader.join();
}

TEST(Inbox, CapacityZeroIsRefused) { EXPECT_THROW(Inbox().addBox(0), std::invalid_argument); }

TEST(BusUrl, ReceiveBufferIsAddedOnceAndOnlyToUdpm) {
  EXPECT_EQ(withReceiveBuffer("udpm://239.255.76.67:7667?ttl=0", 5),
            "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=5");
  EXPECT_EQ(withReceiveBuffer("udpm://239.255.76.67:7667", 5),
            "udpm://239.255.76.67:7667?recv_buf_size=5");
  const std::string own = "udpm://239.255.76.67:7667?recv_buf_size=9";
  EXPECT_EQ(withReceiveBuffer(own, 5), own);
  EXPECT_EQ(receiveBufferOf(own), 9);
  EXPECT_EQ(withReceiveBuffer("memq://", 5), "memq://");
  EXPECT_EQ(filePathOf("file:///tmp/a.lcm?speed=2"), "/tmp/a.lcm");
  EXPECT_EQ(filePathOf("memq://"), "");
}

TEST(NetCheck, TooLargeNamesTheSysctl) {
  const auto text = tooLargeText("OPENNI_FRAME", 921600, 2097152, 212992);
  EXPECT_NE(text.find("net.core.rmem_max"), std::string::npos);
  EXPECT_NE(text.find("921600"), std::string::npos);
  EXPECT_NE(text.find("sudo sysctl -w"), std::string::npos);
}

TEST(NetCheck, GrantedBufferIsWhatTheKernelAllows) {
  EXPECT_EQ(grantedReceiveBuffer(65536), 65536);
  EXPECT_GT(grantedReceiveBuffer(1L << 30), 0);
  EXPECT_LT(grantedReceiveBuffer(1L << 30), 1L << 30);
}

}  // namespace
}  // namespace rf
