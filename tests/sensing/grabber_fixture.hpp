// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>

#include "driver/scene.hpp"
#include "sensing/grabber.hpp"
#include "test_driver.hpp"

namespace rf {

/// A Grabber on the test driver through the real OpenNI2. Images come when the test says so.
class GrabberTest : public testing::Test {
 protected:
  static constexpr int kWidth = 320, kHeight = 240;

  GrabberTest() {
    options_.config.width = kWidth;
    options_.config.height = kHeight;
    options_.config.stall_timeout = 60;  // nothing comes while a test thinks
    options_.config.reconnect_period = 0.05;
    options_.now = [] {
      return std::chrono::duration_cast<std::chrono::microseconds>(
                 std::chrono::system_clock::now().time_since_epoch())
          .count();
    };
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("rf-sensing-") +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    driver_.tell(
        "connect; scene; size depth 0 0; size colour 0 0; drop depth 0; drop colour 0; "
        "late colour 0; release; refuse open off; refuse modes off; refuse registration off");
  }
  ~GrabberTest() override {
    grabber_.reset();
    std::filesystem::remove_all(folder_);
  }

  static testing::AssertionResult says(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "no '" << part << "' in: " << text;
  }

  void open() { grabber_ = std::make_unique<Grabber>(options_); }
  GrabStatus status() const { return grabber_->status(); }

  /// One pair from the driver; waits until `depth` and `colour` images of it are grabbed.
  void show(int depth = 1, int colour = 1) {
    const GrabStatus before = status();
    driver_.tell("frames 1");
    EXPECT_TRUE(becomes([&] {
      const GrabStatus now = status();
      return now.depth_images >= before.depth_images + depth &&
             now.colour_images >= before.colour_images + colour;
    })) << "the images were not grabbed";
  }

  GrabbedFrame next() {
    auto frame = grabber_->next(std::chrono::minutes(1));
    if (!frame) throw std::runtime_error("no frame came");
    return std::move(*frame);
  }

  static void expectPattern(const RgbdFrame& frame, int index) {
    const RgbdFrame shown = patternFrame(index, kWidth, kHeight);
    EXPECT_EQ(frame.depth_mm, shown.depth_mm) << "frame " << index;
    EXPECT_TRUE(frame.colour == shown.colour) << "frame " << index;
  }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  TestDriver driver_;
  GrabOptions options_;
  std::filesystem::path folder_;
  std::unique_ptr<Grabber> grabber_;
};

}  // namespace rf
