// SPDX-License-Identifier: BSD-3-Clause
// What is recorded plays back: every frame, equal depth, the device's times.
#include <cmath>
#include <fstream>

#include "grabber_fixture.hpp"
#include "sensing/error.hpp"
#include "sensing/oni_source.hpp"
#include "sensing/oni_times.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;
constexpr double kMaxGap = 0.02;

class Oni : public GrabberTest {
 protected:
  /// Records `frames` of the pattern.
  std::string recorded(int frames, const std::string& name = "a.oni") {
    options_.record = file(name);
    open();
    for (int i = 0; i < frames; ++i) show();
    grabber_.reset();
    return options_.record;
  }
  static std::string faultOf(const std::string& path) {
    try {
      OniSource source(path, kMaxGap);
    } catch (const SensingError& e) {
      return e.what();
    }
    return "no SensingError";
  }
};

TEST_F(Oni, PlaysFrameForFrameWhatWasRecorded) {
  constexpr int kFrames = 20;
  OniSource source(recorded(kFrames), kMaxGap);
  EXPECT_EQ(source.size(), static_cast<std::size_t>(kFrames));
  EXPECT_NEAR(source.camera().fx, 285.17, 0.01);
  for (int i = 0; i < kFrames; ++i) {
    const auto played = source.next();
    ASSERT_TRUE(played);
    ASSERT_TRUE(played->frame) << played->problem;
    expectPattern(*played->frame, i);
    EXPECT_EQ(played->seq, i);
    EXPECT_EQ(played->utime, patternFrame(i, 1, 1).utime);
    EXPECT_EQ(played->frame->colour_utime, patternFrame(i, 1, 1).colour_utime);
  }
  EXPECT_FALSE(source.next());
  EXPECT_FALSE(source.next());
}

TEST_F(Oni, LossyColourLeavesDepthExact) {
  constexpr int kFrames = 5;
  options_.config.record_lossy_colour = true;
  OniSource source(recorded(kFrames), kMaxGap);
  for (int i = 0; i < kFrames; ++i) {
    const auto played = source.next();
    ASSERT_TRUE(played && played->frame);
    EXPECT_EQ(played->frame->depth_mm, patternFrame(i, kWidth, kHeight).depth_mm);
  }
  EXPECT_FALSE(source.next());
}

TEST_F(Oni, ASlowReaderLosesNothing) {
  constexpr int kFrames = 5;
  OniSource source(recorded(kFrames), kMaxGap);
  for (int i = 0; i < kFrames; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // more than a frame's time
    const auto played = source.next();
    ASSERT_TRUE(played && played->frame);
    expectPattern(*played->frame, i);
  }
}

TEST_F(Oni, DropOutsInTheRecordingAreSaid) {
  options_.config.sync = false;
  options_.record = file("a.oni");
  open();
  show();
  driver_.tell("drop colour 1");
  show(1, 0);
  show();
  driver_.tell("drop depth 1");
  show(0, 1);
  show();
  grabber_.reset();
  OniSource source(options_.record, kMaxGap);
  std::string text;
  while (const auto played = source.next()) text += played->frame ? "+" : "-";
  EXPECT_EQ(text, "+-++");
}

TEST_F(Oni, EachOpeningHasAFileOfItsOwn) {
  options_.record = file("a.oni");
  open();
  show();
  driver_.tell("disconnect");
  EXPECT_TRUE(becomes([&] { return !status().connected; }));
  driver_.tell("connect");
  EXPECT_TRUE(becomes([&] { return status().connected; }));
  show();
  grabber_.reset();
  for (const auto& [name, index] : {std::pair("a.oni", 0), {"a-2.oni", 1}}) {
    OniSource source(file(name), kMaxGap);
    const auto played = source.next();
    ASSERT_TRUE(played && played->frame) << name;
    expectPattern(*played->frame, index);
  }
}

TEST_F(Oni, AMirroredRecordingIsTurnedRound) {
  options_.config.mirror = true;
  OniSource source(recorded(1), kMaxGap);
  const auto played = source.next();
  ASSERT_TRUE(played && played->frame);
  const RgbdFrame shown = patternFrame(0, kWidth, kHeight);
  for (int u = 0; u < kWidth; ++u)
    ASSERT_EQ(played->frame->depth_mm(u, 5), shown.depth_mm(kWidth - 1 - u, 5));
}

TEST_F(Oni, ACalibrationOfAnotherSizeIsRefused) {
  const std::string path = recorded(1);
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  EXPECT_THROW(OniSource(path, kMaxGap, camera), SensingError);
}

TEST_F(Oni, DamagedFilesAreErrorsNotCrashes) {
  const std::string path = recorded(5);
  const auto whole = fs::file_size(path);
  for (const double share : {0.0, 0.0001, 0.001}) {
    fs::copy_file(path, file("cut.oni"), fs::copy_options::overwrite_existing);
    fs::resize_file(file("cut.oni"),
                    static_cast<std::uintmax_t>(share * static_cast<double>(whole)));
    EXPECT_TRUE(says(faultOf(file("cut.oni")), "cut.oni")) << share;
  }
  std::ofstream(file("text.oni")) << "no recording at all";
  EXPECT_TRUE(says(faultOf(file("text.oni")), "is no .oni recording"));
  EXPECT_TRUE(says(faultOf(file("missing.oni")), "missing.oni"));
  std::ofstream(timesFileOf(path)) << "depth_start_us: -1\n";
  EXPECT_THROW(OniSource(path, kMaxGap), std::runtime_error);
}

}  // namespace
}  // namespace rf
