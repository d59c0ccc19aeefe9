// SPDX-License-Identifier: BSD-3-Clause
// From the plugged-in sensor to the map, with real processes, OpenNI2 and the test driver.
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "messaging/conversions.hpp"
#include "messaging/monitor.hpp"
#include "pipeline_fixture.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

testing::AssertionResult says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "no '" << part << "' in:\n" << text;
}

/// What rf-capture says of its frames.
class Ticks {
 public:
  explicit Ticks(const std::string& url) : bus_(url, ""), box_(inbox_.addBox(1024)) {
    bus_.subscribe("RF_FRAME_TICK", inbox_, box_);
    bus_.start();
  }
  std::optional<FrameTick> next(std::chrono::seconds longest) {
    const auto until = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < until) {
      if (const auto raw = inbox_.pop(box_)) {
        auto tick = unpack<rigidfusion::frame_tick_t>(raw->bytes);
        if (tick) return *tick;
      }
      inbox_.waitForNews(std::chrono::milliseconds(50));
    }
    return std::nullopt;
  }

 private:
  Inbox inbox_;
  Bus bus_;
  Inbox::Box box_;
};

class Sensor : public PipelineTest {
 protected:
  static void SetUpTestSuite() { makeShared(); }

  void SetUp() override {
    setenv("LD_LIBRARY_PATH", RF_TEST_OPENNI2, 1);
    fifo_ = own("fifo");
    ASSERT_EQ(mkfifo(fifo_.c_str(), 0600), 0);
    setenv("RF_TEST_DRIVER_FIFO", fifo_.c_str(), 1);
    setenv("RF_TEST_DRIVER", "", 1);
  }

  /// To the driver in the process that was started; waits for it to listen.
  void tell(const std::string& text) const { std::ofstream(fifo_) << text << std::endl; }

  void startCapture(std::vector<std::string> more) {
    more.insert(more.begin(), {"--device", "any", "--set", "capture.device.stall_timeout=60",
                               "--set", "capture.device.reconnect_period=0.05"});
    start("capture", more);
    Watch watch(kState);
    awaitReady(watch);
  }

  /// Shows one frame and returns its tick.
  FrameTick show(Ticks& ticks) {
    tell("frames 1");
    const auto tick = ticks.next(std::chrono::seconds(60));
    if (!tick) throw std::runtime_error("no tick came: " + logOf("capture"));
    return *tick;
  }

  std::string fifo_;
};

TEST_F(Sensor, ListShowsDevicesAndModes) {
  EXPECT_EQ(run("rf-capture", {"--list"}, own("list.txt")), 0);
  for (const char* part : {"rftest/0001@1/2", "640x480@30 DEPTH_1_MM", "640x480@30 RGB888"})
    EXPECT_TRUE(says(contentOf(own("list.txt")), part));
}

TEST_F(Sensor, WithoutADeviceTheExitCodeIsFour) {
  setenv("RF_TEST_DRIVER", "disconnect", 1);
  EXPECT_EQ(run("rf-capture", {"--list"}, own("list.txt")), 4);
  EXPECT_EQ(run("rf-capture", {"--device", "any", "--bulk-in", kBulk, "--state-in", kState},
                own("said.txt")),
            4);
  for (const char* part : {"lsusb", "libopenni2-0", "USB 2", "60-libopenni2-0.rules"})
    EXPECT_TRUE(says(contentOf(own("said.txt")), part));
}

TEST_F(Sensor, FaultsAreSaidAndThePipelineGoesOn) {
  startCapture({});
  Ticks ticks(kState);
  Watch watch(kState);
  EXPECT_EQ(show(ticks).state, TickState::kPublished);
  tell("size depth 320 240");
  const FrameTick small = show(ticks);
  EXPECT_EQ(small.state, TickState::kLost);
  EXPECT_TRUE(says(small.reason, "depth of 320x240: must be 640x480"));
  tell("size depth 0 0");
  EXPECT_EQ(show(ticks).state, TickState::kPublished);
  const auto stateBecomes = [&](ServiceState state) {
    for (int i = 0; i < 600; ++i) {
      watch.update(std::chrono::milliseconds(100));
      const auto& all = watch.statuses();
      const auto it = all.find("capture");
      if (it != all.end() && it->second.state == static_cast<std::int32_t>(state)) return true;
    }
    return false;
  };
  tell("disconnect");
  EXPECT_TRUE(stateBecomes(ServiceState::kDegraded));
  EXPECT_TRUE(says(watch.statuses().at("capture").state_text, "was unplugged"));
  tell("connect rftest/0001@2/9");
  EXPECT_TRUE(stateBecomes(ServiceState::kRunning));
  const FrameTick back = show(ticks);
  EXPECT_EQ(back.state, TickState::kPublished);
  EXPECT_EQ(back.seq, 3);
  stopAll();
  EXPECT_TRUE(says(logOf("capture"), "the device is back"));
}

TEST_F(Sensor, ARecordingGivesTheResultOfItsSource) {
  setenv("RF_TEST_DRIVER", ("scene " + shared("cut")).c_str(), 1);
  startCapture({"--record", own("cut.oni"), "--calibration", shared("cut/camera.yaml")});
  Ticks ticks(kState);
  for (int i = 0; i < kFrames; ++i) {
    const FrameTick tick = show(ticks);
    ASSERT_EQ(tick.state, TickState::kPublished) << tick.reason;
    ASSERT_EQ(tick.seq, i);
  }
  stopAll();
  const std::vector<std::string> job = {"--calibration", shared("cut/camera.yaml"),
                                        "--camera-prior", shared("cut/odometry.txt"),
                                        "--write-masks"};
  const auto resultOf = [&](const std::string& program, const std::string& input,
                            const std::string& name) {
    std::vector<std::string> arguments = job;
    arguments.insert(arguments.end(), {"--input", input, "--output", own(name)});
    if (program == "rf-launch") arguments.insert(arguments.end(), {"--port", "7721"});
    EXPECT_EQ(run(program, arguments, own(name + ".txt")), 0) << contentOf(own(name + ".txt"));
    return contentOf(own(name + "/camera.txt")) + contentOf(own(name + "/static.ply"));
  };
  const std::string from_folder = resultOf("rf-run", shared("cut"), "folder");
  EXPECT_EQ(linesOf(own("folder/camera.txt")).size(), static_cast<std::size_t>(kFrames));
  EXPECT_TRUE(resultOf("rf-run", own("cut.oni"), "oni") == from_folder);
  EXPECT_TRUE(resultOf("rf-launch", own("cut.oni"), "launched") == from_folder);
  EXPECT_EQ(run("rf-capture", {"--device", "any", "--record", own("cut.oni")}, own("again.txt")),
            2);
  EXPECT_TRUE(says(contentOf(own("again.txt")), "exists already"));
}

/// The commands of the page's block that begins with this line.
std::vector<std::string> commandsOf(const std::string& page, const std::string& first) {
  std::ifstream in(page);
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);) {
    const auto begin = line.find_first_not_of(' ');
    const bool code = begin == 4;
    if (out.empty() && (!code || line.substr(4).rfind(first, 0) != 0)) continue;
    if (!code) break;
    out.push_back(line.substr(
        4, line.find("  #") == std::string::npos ? std::string::npos : line.find("  #") - 4));
  }
  return out;
}

TEST_F(Sensor, FiveCommandsFromTheSensorToTheFirstMap) {
  const auto commands = commandsOf(RF_SENSOR_PAGE, "tools/install-packages");
  ASSERT_EQ(commands.size(), 5U);
  EXPECT_TRUE(says(commands[0], "tools/install-packages"));
  EXPECT_TRUE(says(commands[1], "cmake --preset release"));
  // The first two made the programs that this test runs; the rest as they stand, but for the
  // folder.
  fs::create_directories(own("build/release"));
  fs::create_directory_symlink(RF_BIN_DIR, own("build/release/bin"));
  const auto inShell = [&](const std::string& command, const std::string& log) {
    return std::make_unique<Child>(
        log, std::vector<std::string>{"/bin/sh", "-c", "cd " + own("") + " && exec " + command},
        own(log));
  };
  EXPECT_EQ(inShell(commands[2], "list.txt")->waitFor(std::chrono::seconds(60)), 0);
  EXPECT_TRUE(says(contentOf(own("list.txt")), "640x480@30"));

  setenv("RF_TEST_DRIVER", ("scene " + shared("cut")).c_str(), 1);
  const auto launch = inShell(commands[3], "launch.txt");
  Watch watch("udpm://239.255.76.67:7668?ttl=0");
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (!watch.ready("capture") && !launch->exitCode()) {
    watch.update(std::chrono::milliseconds(50));
    ASSERT_LT(std::chrono::steady_clock::now(), until);
  }
  for (int shown = 0; shown < kFrames && !launch->exitCode(); ++shown) {
    const auto before = watch.results();
    tell("frames 1");
    while (watch.results() == before && !launch->exitCode()) {
      watch.update(std::chrono::milliseconds(50));
      ASSERT_LT(std::chrono::steady_clock::now(), until) << launch->logTail();
    }
  }
  kill(launch->pid(), SIGINT);  // Ctrl-C
  EXPECT_EQ(launch->waitFor(std::chrono::seconds(60)), 0) << contentOf(own("launch.txt"));
  EXPECT_EQ(linesOf(own("map/camera.txt")).size(), static_cast<std::size_t>(kFrames));
  EXPECT_GT(fs::file_size(own("map/static.ply")), 100000U);

  EXPECT_EQ(inShell(commands[4], "render.txt")->waitFor(std::chrono::seconds(120)), 0)
      << contentOf(own("render.txt"));
}

}  // namespace
}  // namespace rf
