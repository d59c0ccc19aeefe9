// SPDX-License-Identifier: BSD-3-Clause
// rf-simulate as a process: what it writes, refuses, and leaves behind when it is stopped.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace rf {
namespace {

namespace fs = std::filesystem;

class RfSimulate : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "rf-simulate-test-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Starts the program; its output goes to files in the test's folder.
  pid_t start(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), std::string(RF_BIN_DIR) + "/rf-simulate");
    const std::string out = (folder_ / "stdout").string();
    const std::string err = (folder_ / "stderr").string();
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    const pid_t pid = fork();
    if (pid == 0) {
      dup2(open(out.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), 1);
      dup2(open(err.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), 2);
      execv(argv[0], argv.data());
      _exit(127);
    }
    return pid;
  }
  static int finish(pid_t pid) {
    int status = 0;
    waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }
  int run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }
  static std::string text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    return all.str();
  }
  static int entries(const fs::path& list) {
    std::istringstream in(text(list));
    std::string line;
    int n = 0;
    while (std::getline(in, line)) n += !line.empty() && line[0] != '#' ? 1 : 0;
    return n;
  }
  static int files(const fs::path& folder) {
    if (!fs::is_directory(folder)) return 0;
    return static_cast<int>(std::distance(fs::directory_iterator(folder), {}));
  }

  fs::path folder_;
};

TEST_F(RfSimulate, ListsItsScenes) {
  ASSERT_EQ(run({"--list"}), 0);
  const std::string list = text(folder_ / "stdout");
  for (const char* scene : {"straight", "orbit", "overtake", "sideway", "size030", "size085",
                            "held", "loop", "two_objects", "leave", "behind"}) {
    EXPECT_NE(list.find(scene), std::string::npos) << scene;
  }
}

TEST_F(RfSimulate, WritesTheWholeLayoutAndTheSameBytesAgain) {
  const std::string a = (folder_ / "a").string();
  const std::string b = (folder_ / "b").string();
  ASSERT_EQ(
      run({"--scene", "held", "--seed", "4", "--start", "30", "--frames", "2", "--output", a}), 0)
      << text(folder_ / "stderr");
  ASSERT_EQ(run({"--scene", "held", "--seed", "4", "--start", "30", "--frames", "2", "--output", b,
                 "--threads", "2"}),
            0);
  for (const char* file :
       {"rgb.txt", "depth.txt", "camera.yaml", "groundtruth.txt", "object_groundtruth.txt",
        "odometry.txt", "object_odometry.txt", "object_motion.txt", "surface.ply",
        "object_surface.ply", "rgb/1001.000000.png", "depth/1001.033333.png",
        "mask/1001.033333.png"}) {
    EXPECT_FALSE(text(fs::path(a) / file).empty()) << file;
    EXPECT_EQ(text(fs::path(a) / file), text(fs::path(b) / file)) << file;
  }
  EXPECT_EQ(entries(fs::path(a) / "depth.txt"), 2);
  EXPECT_EQ(entries(fs::path(a) / "odometry.txt"), 2);
  EXPECT_EQ(run({"--scene", "held", "--frames", "1", "--output", a}), 1) << "not empty";
  EXPECT_NE(text(folder_ / "stderr").find("--overwrite"), std::string::npos);
  EXPECT_EQ(run({"--scene", "held", "--frames", "1", "--output", a, "--overwrite", "--camera-drift",
                 "none", "--object-drift", "none"}),
            0);
  EXPECT_EQ(files(fs::path(a) / "rgb"), 1);
  EXPECT_FALSE(fs::exists(fs::path(a) / "odometry.txt"));
  EXPECT_FALSE(fs::exists(fs::path(a) / "object_odometry.txt"));
}

TEST_F(RfSimulate, RefusesWithTheFieldAndTheRule) {
  const std::string out = (folder_ / "x").string();
  EXPECT_EQ(run({"--scene", "nowhere", "--output", out}), 1);
  EXPECT_NE(text(folder_ / "stderr").find("sideway"), std::string::npos) << "lists the known";
  EXPECT_EQ(run({"--scene", "held", "--camera-drift", "-1,0", "--output", out}), 1);
  EXPECT_NE(text(folder_ / "stderr").find("--camera-drift"), std::string::npos);
  EXPECT_EQ(run({"--scene", "held", "--start", "400", "--output", out}), 1);
  EXPECT_NE(text(folder_ / "stderr").find("--start = 400"), std::string::npos);
  EXPECT_NE(run({"--frames", "-3"}), 0);
  EXPECT_FALSE(fs::exists(out)) << "nothing is written before the arguments are checked";
}

TEST_F(RfSimulate, ASignalLeavesAValidShorterSequence) {
  const fs::path out = folder_ / "s";
  const pid_t pid = start({"--scene", "sideway", "--output", out.string()});
  const auto begin = std::chrono::steady_clock::now();
  while (files(out / "mask") < 3 &&
         std::chrono::steady_clock::now() - begin < std::chrono::seconds(120)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(pid, SIGTERM);
  EXPECT_EQ(finish(pid), 130);
  const int n = entries(out / "depth.txt");
  EXPECT_GE(n, 2);
  EXPECT_LT(n, 450);
  EXPECT_EQ(n, files(out / "depth"));
  EXPECT_EQ(n, files(out / "rgb"));
  EXPECT_EQ(n, entries(out / "groundtruth.txt"));
  EXPECT_EQ(n, entries(out / "odometry.txt"));
}

}  // namespace
}  // namespace rf
