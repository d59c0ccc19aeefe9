// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/log_file.hpp"

#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "messaging/bus.hpp"

namespace rf {
namespace {

class LogFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = ::testing::TempDir() + "rf_log_" + std::to_string(getpid()) + "_" +
            ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".lcm";
  }
  void TearDown() override { std::filesystem::remove(path_); }

  void writeEvents(int n, std::size_t bytes = 1000) {
    LogWriter writer(path_);
    for (int i = 0; i < n; ++i) {
      writer.write(1000 * i, i % 2 == 0 ? "RF_A" : "RF_B",
                   std::vector<std::uint8_t>(bytes, static_cast<std::uint8_t>(i)));
    }
    writer.flush();
    EXPECT_EQ(writer.events(), n);
    EXPECT_EQ(writer.bytes(), static_cast<std::int64_t>(std::filesystem::file_size(path_)));
  }
  void overwrite(std::int64_t at, std::uint8_t value) {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(at);
    file.put(static_cast<char>(value));
  }
  int countEvents(LogReader& reader) {
    int n = 0;
    while (reader.next()) ++n;
    return n;
  }
  static constexpr std::int64_t kEventBytes = 28 + 4 + 1000;

  std::string path_;
};

TEST_F(LogFile, IsWhatLiblcmReads) {
  writeEvents(5);
  lcm_eventlog_t* log = lcm_eventlog_create(path_.c_str(), "r");
  ASSERT_NE(log, nullptr);
  for (int i = 0; i < 5; ++i) {
    lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log);
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, i);
    EXPECT_EQ(event->timestamp, 1000 * i);
    EXPECT_EQ(event->datalen, 1000);
    EXPECT_EQ(std::string(event->channel, 4), i % 2 == 0 ? "RF_A" : "RF_B");
    lcm_eventlog_free_event(event);
  }
  lcm_eventlog_destroy(log);
}

TEST_F(LogFile, RoundTrip) {
  writeEvents(20);
  LogReader reader(path_);
  for (int i = 0; i < 20; ++i) {
    const auto event = reader.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->number, i);
    EXPECT_EQ(event->utime, 1000 * i);
    EXPECT_EQ(event->data, std::vector<std::uint8_t>(1000, static_cast<std::uint8_t>(i)));
  }
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.damages(), 0);
  EXPECT_FALSE(reader.truncated());
}

TEST_F(LogFile, TruncatedTailEndsTheLogAndIsSaid) {
  writeEvents(20);
  for (const std::int64_t cut :
       {std::int64_t{1}, std::int64_t{500}, kEventBytes - 1, kEventBytes - 10}) {
    std::filesystem::resize_file(path_, static_cast<std::uintmax_t>(20 * kEventBytes - cut));
    LogReader reader(path_);
    EXPECT_EQ(countEvents(reader), 19) << cut;
    EXPECT_TRUE(reader.truncated());
  }
}

TEST_F(LogFile, OneFlippedByteCostsAtMostOneEvent) {
  for (const std::int64_t at : {0, 1, 3, 20, 23, 24, 25, 26, 27, 30, 500}) {
    writeEvents(20);
    overwrite(7 * kEventBytes + at, 0x7F);
    LogReader reader(path_);
    EXPECT_GE(countEvents(reader), 19) << "byte " << at;
    EXPECT_LE(reader.damages(), 1);
  }
}

TEST_F(LogFile, LengthThatSwallowsOthersIsSeenThrough) {
  writeEvents(20);
  overwrite(7 * kEventBytes + 26,
            0x10);  // claims about 4 KB: a plausible length that covers 3 more
  LogReader reader(path_);
  EXPECT_EQ(countEvents(reader), 19);
  EXPECT_EQ(reader.damages(), 1);
  EXPECT_EQ(reader.skippedBytes(), kEventBytes);
}

TEST_F(LogFile, GarbageIsNoLog) {
  std::ofstream(path_) << std::string(100000, 'x');
  LogReader reader(path_);
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.damages(), 1);
}

TEST_F(LogFile, MissingFileAndBadEventsAreErrors) {
  EXPECT_THROW(LogReader("/nonexistent/x.lcm"), std::runtime_error);
  EXPECT_THROW(LogWriter("/nonexistent/x.lcm"), std::runtime_error);
  LogWriter writer(path_);
  EXPECT_THROW(writer.write(0, "", {}), std::invalid_argument);
  EXPECT_THROW(writer.write(0, std::string(64, 'X'), {}), std::invalid_argument);
}

TEST_F(LogFile, FileUrlDeliversEverythingInOrder) {
  writeEvents(200);
  Inbox inbox;
  const auto box = inbox.addBox(4, Overflow::kWait);
  Bus bus("file://" + path_, "");
  EXPECT_FALSE(bus.liveInput());
  bus.subscribe("RF_A", inbox, box);
  bus.start();
  int n = 0;
  while (!bus.inputEnded() || inbox.depth() > 0) {
    while (const auto m = inbox.pop(box))
      EXPECT_EQ(m->bytes[0], static_cast<std::uint8_t>(2 * n++));
    inbox.waitForNews(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(n, 100);
  EXPECT_EQ(inbox.dropped(), 0);
}

}  // namespace
}  // namespace rf
