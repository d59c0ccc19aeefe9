// SPDX-License-Identifier: BSD-3-Clause
// Field of view, queue, choice of a device.
#include <gtest/gtest.h>

#include <cmath>

#include "sensing/field_of_view.hpp"
#include "sensing/frame_queue.hpp"
#include "sensing/openni_session.hpp"

namespace rf {
namespace {

constexpr auto kNow = std::chrono::milliseconds(0);

TEST(FieldOfView, EdgesOfTheImageAreAtHalfTheAngle) {
  const Camera camera = cameraOfFieldOfView(640, 480, 1.0225999, 0.79661566);
  EXPECT_NEAR(camera.fx, 570.34, 0.01);  // what PrimeSense's sensors are known for
  EXPECT_NEAR(camera.fy, 570.34, 0.01);
  const double left = std::atan((-0.5 - camera.cx) / camera.fx);
  const double right = std::atan((639.5 - camera.cx) / camera.fx);
  EXPECT_NEAR(right - left, 1.0225999, 1e-12);
  EXPECT_NEAR(right + left, 0, 1e-12);
}

TEST(FieldOfView, UnusableAnglesAreRefused) {
  EXPECT_THROW(cameraOfFieldOfView(640, 480, 0, 0.8), std::invalid_argument);
  EXPECT_THROW(cameraOfFieldOfView(640, 480, 1, std::nan("")), std::invalid_argument);
  EXPECT_THROW(cameraOfFieldOfView(0, 480, 1, 0.8), std::invalid_argument);
}

GrabbedFrame whole(std::int64_t seq) {
  GrabbedFrame frame;
  frame.seq = seq;
  frame.frame = RgbdFrame{};
  return frame;
}

TEST(FrameQueue, NewestStayAndTheOldKeepTheirNumbers) {
  FrameQueue queue(2);
  for (int i = 0; i < 5; ++i) queue.push(whole(i));
  for (int i = 0; i < 5; ++i) {
    const auto frame = queue.pop(kNow);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->seq, i);
    EXPECT_EQ(frame->frame.has_value(), i >= 3);
    EXPECT_EQ(frame->problem.empty(), i >= 3);
  }
  EXPECT_FALSE(queue.pop(kNow));
  EXPECT_EQ(queue.dropped(), 3);
}

TEST(FrameQueue, IsBoundedHoweverLongNobodyReads) {
  FrameQueue queue(2);
  for (int i = 0; i < 5000; ++i) queue.push(whole(i));
  int left = 0;
  while (queue.pop(kNow)) ++left;
  EXPECT_LE(left, 300);
  EXPECT_EQ(queue.dropped(), 4998);
}

TEST(ChooseDevice, ByUriOrByKindAfterAReplug) {
  const std::vector<DeviceName> two = {{"1d27/0600@1/5", "", "", 0, 0},
                                       {"1d27/0601@1/6", "", "", 0, 0}};
  EXPECT_EQ(chooseDevice(two, "any"), 0);
  EXPECT_EQ(chooseDevice(two, "1d27/0601@1/6"), 1);
  EXPECT_EQ(chooseDevice(two, "1d27/0601@1/9"), 1);
  EXPECT_EQ(chooseDevice(two, "045e/02ae@1/9"), -1);
  EXPECT_EQ(chooseDevice({}, "any"), -1);
  const std::vector<DeviceName> twins = {{"1d27/0600@1/5", "", "", 0, 0},
                                         {"1d27/0600@1/6", "", "", 0, 0}};
  EXPECT_EQ(chooseDevice(twins, "1d27/0600@1/7"), -1) << "which of the two is meant?";
}

}  // namespace
}  // namespace rf
