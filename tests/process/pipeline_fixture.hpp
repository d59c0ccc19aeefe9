// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "launch/child.hpp"
#include "launch/watch.hpp"

namespace rf {

/// Programs of the build on a short cut of a real recording, on buses that nobody else uses.
class PipelineTest : public testing::Test {
 protected:
  static constexpr int kFrames = 10;
  static constexpr const char* kBulk = "udpm://239.255.76.67:7701?ttl=0";
  static constexpr const char* kState = "udpm://239.255.76.67:7702?ttl=0";

  /// The cut, its result by rf-run and its recording by rf-launch: made once.
  static void SetUpTestSuite();
  /// The folder and the cut alone.
  static void makeShared();
  static void TearDownTestSuite();
  void TearDown() override { services_.clear(); }

  static std::string shared(const std::string& name) { return (folder_ / name).string(); }
  /// A fresh folder of this test.
  std::string own(const std::string& name) const;
  static std::vector<std::string> linesOf(const std::string& file);
  static std::string contentOf(const std::string& file);

  /// Runs a program to its end; what it said goes to `log`. Returns its exit code.
  static int run(const std::string& program, const std::vector<std::string>& arguments,
                 const std::string& log);
  /// Starts rf-<name> on the test's buses (`one_bus`: both on the bulk URL).
  void start(const std::string& name, const std::vector<std::string>& arguments,
             bool one_bus = false);
  /// Waits for the heartbeats of all that were started.
  void awaitReady(Watch& watch);
  /// SIGTERM to all; expects exit code 0 of each.
  void stopAll();
  /// What rf-<name> said.
  std::string logOf(const std::string& name) const { return contentOf(own("rf-" + name + ".txt")); }

  /// The program that start() started as `name`.
  Child& started(const std::string& name);

  /// rf-segment and rf-fuse in lockstep, fed with a log by rf-replay; returns rf-replay's exit
  /// code.
  int replay(const std::string& log, const std::vector<std::string>& more = {});
  /// camera.txt, object.txt and every mask equal those of rf-run.
  static void expectSameAsOffline(const std::string& result) {
    expectSame(result, shared("offline"));
  }
  /// The same of two result folders of the cut.
  static void expectSame(const std::string& result, const std::string& offline);

  static std::filesystem::path folder_;

 private:
  std::vector<std::unique_ptr<Child>> services_;
};

}  // namespace rf
