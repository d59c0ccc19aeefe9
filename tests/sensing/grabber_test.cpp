// SPDX-License-Identifier: BSD-3-Clause
// The grabbing thread against a device that works, fails, leaves and returns.
#include "grabber_fixture.hpp"
#include "sensing/error.hpp"
#include "sensing/survey.hpp"

namespace rf {
namespace {

constexpr std::int64_t kGapUs = 4000;  ///< the pattern's colour comes so long after depth

std::string faultOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const SensingError& e) {
    return e.what();
  }
  return "no SensingError";
}

TEST_F(GrabberTest, FramesComeAsTheDeviceShowsThem) {
  open();
  std::int64_t last = 0;
  for (int i = 0; i < 10; ++i) {
    show();
    const GrabbedFrame grabbed = next();
    ASSERT_TRUE(grabbed.frame) << grabbed.problem;
    expectPattern(*grabbed.frame, i);
    EXPECT_EQ(grabbed.seq, i);
    EXPECT_EQ(grabbed.frame->seq, i);
    EXPECT_EQ(grabbed.gap_us, kGapUs);
    EXPECT_EQ(grabbed.frame->colour_utime - grabbed.frame->utime, kGapUs);
    EXPECT_GT(grabbed.utime, last);
    last = grabbed.utime;
  }
}

TEST_F(GrabberTest, TheDeviceIsSetUpAsConfigured) {
  options_.config.auto_exposure = false;
  options_.config.exposure = 33;
  options_.config.auto_white_balance = false;
  open();
  for (const char* note : {"registration=1", "sync=2", "depth_mirror=0", "colour_mirror=0",
                           "auto_exposure=0", " exposure=33", "auto_white_balance=0"})
    EXPECT_TRUE(says(driver_.notes(), note));
  EXPECT_TRUE(grabber_->takeNotes().empty());
}

TEST_F(GrabberTest, FactoryIntrinsicsComeFromTheFieldOfView) {
  open();
  const auto camera = grabber_->camera();
  ASSERT_TRUE(camera);
  EXPECT_NEAR(camera->fx, 285.17, 0.01);
  EXPECT_EQ(camera->cx, 159.5);
}

TEST_F(GrabberTest, ACalibrationOfAnotherSizeIsRefused) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  options_.calibration = camera;
  EXPECT_THROW(open(), std::invalid_argument);
}

TEST_F(GrabberTest, AModeThatTheDeviceLacksIsExplained) {
  options_.config.width = 1000;
  const std::string fault = faultOf([&] { open(); });
  EXPECT_TRUE(says(fault, "1000x240@30"));
  EXPECT_TRUE(says(fault, "640x480@30, 320x240@30, 320x240@60"));
}

TEST_F(GrabberTest, AModeThatTheDeviceRefusesIsExplained) {
  driver_.tell("refuse modes on");
  EXPECT_TRUE(says(faultOf([&] { open(); }), "320x240@30"));
}

TEST_F(GrabberTest, MissingRegistrationNamesTheSetting) {
  driver_.tell("refuse registration on");
  EXPECT_TRUE(says(faultOf([&] { open(); }), "capture.device.registration=false"));
  options_.config.registration = false;
  open();
  show();
  EXPECT_TRUE(next().frame);
}

TEST_F(GrabberTest, NoDeviceSaysWhatToCheck) {
  driver_.tell("disconnect");
  const std::string fault = faultOf([&] { open(); });
  for (const char* word : {"lsusb", "USB 2", "libopenni2-0", "60-libopenni2-0.rules", "--wait"})
    EXPECT_TRUE(says(fault, word));
  EXPECT_EQ(surveyDevices(), "");
}

TEST_F(GrabberTest, ADeviceThatCannotBeOpenedIsNamed) {
  driver_.tell("refuse open on");
  EXPECT_TRUE(says(faultOf([&] { open(); }), "rftest/0001@1/2: cannot be opened"));
  EXPECT_TRUE(says(surveyDevices(), "cannot be opened"));
}

TEST_F(GrabberTest, TheSurveyListsModes) {
  const std::string text = surveyDevices();
  for (const char* part : {"rftest/0001@1/2", "Test sensor", "serial RF-TEST-1", "colour: yes",
                           "640x480@30 DEPTH_1_MM", "320x240@60 RGB888", "1.0226 x 0.7966 rad"})
    EXPECT_TRUE(says(text, part));
}

TEST_F(GrabberTest, WaitsForADeviceWhenAsked) {
  driver_.tell("disconnect");
  options_.wait = true;
  open();
  EXPECT_FALSE(status().connected);
  EXPECT_FALSE(grabber_->camera());
  driver_.tell("connect");
  EXPECT_TRUE(becomes([&] { return status().connected; }));
  EXPECT_TRUE(grabber_->camera());
  show();
  EXPECT_TRUE(next().frame);
}

TEST_F(GrabberTest, ADroppedColourImageCostsItsFrameOnly) {
  options_.config.sync = false;
  open();
  show();
  driver_.tell("drop colour 1");
  show(1, 0);
  show();
  EXPECT_TRUE(next().frame);
  const GrabbedFrame lost = next();
  EXPECT_FALSE(lost.frame);
  EXPECT_EQ(lost.seq, 1);
  EXPECT_TRUE(says(lost.problem, "max_pair_gap"));
  const GrabbedFrame after = next();
  ASSERT_TRUE(after.frame);
  expectPattern(*after.frame, 2);
  EXPECT_EQ(after.seq, 2);
  EXPECT_EQ(status().unpaired, 1);
}

TEST_F(GrabberTest, SynchronisedStreamsGiveWholePairsOnly) {
  open();
  show();
  driver_.tell("drop colour 1; frames 1");  // OpenNI2 itself holds the lone depth image back
  show();
  for (const int index : {0, 2}) {
    const GrabbedFrame grabbed = next();
    ASSERT_TRUE(grabbed.frame);
    expectPattern(*grabbed.frame, index);
  }
}

TEST_F(GrabberTest, ALateColourImageIsPairedByItsTime) {
  options_.config.sync = false;
  open();
  driver_.tell("late colour 1");
  show(1, 0);
  driver_.tell("release");
  const GrabbedFrame grabbed = next();
  ASSERT_TRUE(grabbed.frame);
  expectPattern(*grabbed.frame, 0);
  EXPECT_EQ(grabbed.gap_us, kGapUs);
}

TEST_F(GrabberTest, AWrongSizeIsSaidAndTheRestGoesOn) {
  open();
  driver_.tell("size depth 160 120");
  show(0, 1);
  EXPECT_TRUE(becomes([&] { return status().bad == 1; }));
  driver_.tell("size depth 0 0; size colour 640 480");
  show(1, 0);
  EXPECT_TRUE(becomes([&] { return status().bad == 2; }));
  driver_.tell("size colour 0 0");
  show();
  const GrabbedFrame small = next();
  EXPECT_FALSE(small.frame);
  EXPECT_TRUE(says(small.problem, "depth of 160x120: must be 320x240"));
  EXPECT_FALSE(next().frame);  // no colour near it
  const GrabbedFrame good = next();
  ASSERT_TRUE(good.frame) << good.problem;
  expectPattern(*good.frame, 2);
  EXPECT_EQ(status().bad, 2);
}

TEST_F(GrabberTest, AnUnpluggedDeviceIsFoundAgainElsewhere) {
  open();
  show();
  const GrabbedFrame before = next();
  driver_.tell("disconnect");
  EXPECT_TRUE(becomes([&] { return !status().connected; }));
  EXPECT_TRUE(says(status().text, "rftest/0001@1/2 was unplugged"));
  driver_.tell("jump -500000; connect rftest/0001@2/7");
  EXPECT_TRUE(becomes([&] { return status().connected; }));
  EXPECT_TRUE(says(status().text, "rftest/0001@2/7"));
  show();
  const GrabbedFrame after = next();
  ASSERT_TRUE(after.frame);
  expectPattern(*after.frame, 1);
  EXPECT_EQ(after.seq, before.seq + 1);
  EXPECT_GT(after.utime, before.utime);
  EXPECT_EQ(status().openings, 2);
  driver_.tell("disconnect; connect rftest/0001@1/2");
}

TEST_F(GrabberTest, ADeviceThatGoesSilentIsOpenedAnew) {
  options_.config.stall_timeout = 0.1;
  open();
  EXPECT_TRUE(becomes([&] { return status().openings >= 2; }));
  EXPECT_TRUE(says(grabber_->takeNotes().front(), "no image for 0.1 s"));
  driver_.tell("free 100");
  EXPECT_TRUE(next().frame);
  driver_.tell("hold");
}

TEST_F(GrabberTest, AReaderThatStandsStillNeverHoldsUpGrabbing) {
  constexpr int kShown = 50;
  open();
  for (int i = 0; i < kShown; ++i) show();  // each is grabbed while nobody reads
  EXPECT_TRUE(becomes([&] { return status().frames == kShown; }));
  EXPECT_EQ(status().dropped, kShown - options_.config.queue);
  for (int i = 0; i < kShown; ++i) {
    const GrabbedFrame grabbed = next();
    EXPECT_EQ(grabbed.seq, i);
    ASSERT_EQ(grabbed.frame.has_value(), i >= kShown - options_.config.queue);
    if (grabbed.frame) expectPattern(*grabbed.frame, i);
  }
}

}  // namespace
}  // namespace rf
