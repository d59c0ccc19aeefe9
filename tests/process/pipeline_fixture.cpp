// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline_fixture.hpp"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

namespace rf {
namespace {

namespace fs = std::filesystem;
constexpr std::chrono::seconds kLongest(300);

/// The first frames of a TUM folder; images are links to the originals.
void makeCut(const fs::path& from, const fs::path& to, int frames) {
  fs::create_directories(to);
  for (const char* name : {"camera.yaml", "groundtruth.txt"}) fs::copy_file(from / name, to / name);
  fs::copy_file(from / "groundtruth.txt", to / "odometry.txt");
  for (const char* kind : {"rgb", "depth"}) {
    fs::create_directories(to / kind);
    std::ifstream in(from / (std::string(kind) + ".txt"));
    std::ofstream out(to / (std::string(kind) + ".txt"));
    std::string line;
    for (int n = 0; n < frames && std::getline(in, line);) {
      out << line << '\n';
      if (line.empty() || line[0] == '#') continue;
      ++n;
      const std::string image = line.substr(line.find(' ') + 1);
      fs::copy_file(from / image, to / image);
    }
  }
}

}  // namespace

fs::path PipelineTest::folder_;

void PipelineTest::makeShared() {
  folder_ = fs::temp_directory_path() / ("rf-process-" + std::to_string(getpid()));
  fs::remove_all(folder_);
  makeCut(fs::path(RF_TEST_DATA) / "tum_fr1_rpy", folder_ / "cut", kFrames);
}

void PipelineTest::SetUpTestSuite() {
  makeShared();
  const std::vector<std::string> job = {"--input", shared("cut"), "--write-masks",
                                        "--simulate-drift", "0.06,0.4"};
  auto offline = job, launched = job;
  offline.insert(offline.end(), {"--output", shared("offline"), "--threads", "1"});
  launched.insert(launched.end(), {"--output", shared("launched"), "--port", "7711"});
  ASSERT_EQ(run("rf-run", offline, shared("rf-run.txt")), 0) << contentOf(shared("rf-run.txt"));
  ASSERT_EQ(run("rf-launch", launched, shared("rf-launch.txt")), 0)
      << contentOf(shared("rf-launch.txt"));
}

void PipelineTest::TearDownTestSuite() { fs::remove_all(folder_); }

std::string PipelineTest::own(const std::string& name) const {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const fs::path path = folder_ / test->name();
  fs::create_directories(path);
  return (path / name).string();
}

std::string PipelineTest::contentOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> PipelineTest::linesOf(const std::string& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  return lines;
}

int PipelineTest::run(const std::string& program, const std::vector<std::string>& arguments,
                      const std::string& log) {
  std::vector<std::string> command{std::string(RF_BIN_DIR) + "/" + program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  Child child(program, command, log);
  return child.waitFor(kLongest);
}

void PipelineTest::start(const std::string& name, const std::vector<std::string>& arguments,
                         bool one_bus) {
  std::vector<std::string> command{std::string(RF_BIN_DIR) + "/rf-" + name, "--bulk-in", kBulk,
                                   "--state-in", one_bus ? kBulk : kState};
  command.insert(command.end(), arguments.begin(), arguments.end());
  services_.push_back(std::make_unique<Child>(name, command, own("rf-" + name + ".txt")));
}

void PipelineTest::awaitReady(Watch& watch) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  for (const auto& service : services_) {
    while (!watch.ready(service->name())) {
      watch.update(std::chrono::milliseconds(50));
      ASSERT_FALSE(service->exitCode().has_value()) << service->logTail();
      ASSERT_LT(std::chrono::steady_clock::now(), until) << service->name();
    }
  }
}

Child& PipelineTest::started(const std::string& name) {
  for (const auto& service : services_)
    if (service->name() == name) return *service;
  throw std::invalid_argument(name + " was not started");
}

void PipelineTest::stopAll() {
  for (const auto& service : services_) {
    service->askToStop();
    EXPECT_EQ(service->waitFor(std::chrono::seconds(60)), 0)
        << service->name() << ": " << service->logTail();
  }
}

int PipelineTest::replay(const std::string& log, const std::vector<std::string>& more) {
  start("segment", {"--lockstep"});
  start("fuse", {"--lockstep", "--write-masks", "--output", own("result")});
  std::vector<std::string> command = {"--bulk-in", kBulk, "--state-in", kState, log};
  command.insert(command.end(), more.begin(), more.end());
  const int code = run("rf-replay", command, own("rf-replay.txt"));
  stopAll();
  return code;
}

void PipelineTest::expectSame(const std::string& result, const std::string& offline) {
  EXPECT_EQ(linesOf(offline + "/camera.txt").size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(contentOf(result + "/camera.txt"), contentOf(offline + "/camera.txt"));
  EXPECT_EQ(contentOf(result + "/object.txt"), contentOf(offline + "/object.txt"));
  int masks = 0;
  for (const auto& entry : fs::directory_iterator(offline + "/masks")) {
    ++masks;
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(contentOf(result + "/masks/" + name), contentOf(entry.path().string())) << name;
  }
  EXPECT_EQ(masks, kFrames);
}

}  // namespace rf
