// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/depth_noise.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

/// Frames of a sensor whose residuals are `rms` of the model's own sigma.
void track(DepthNoise& noise, double rms, int frames) {
  for (int k = 0; k < frames; ++k) noise.learn(rms / noise.factor());
}

TEST(DepthNoise, StaysAtOneWhereTheModelHolds) {
  DepthNoise noise(1.0);
  track(noise, 0.88, 100);
  EXPECT_EQ(noise.factor(), 1.0);
  track(noise, 0.5, 100);
  EXPECT_EQ(noise.factor(), 1.0) << "never narrower than configured";
}

TEST(DepthNoise, FindsTwiceTheNoiseAndItsEnd) {
  DepthNoise noise(1.0);
  track(noise, 1.75, 5);
  EXPECT_NEAR(noise.factor(), 1.95, 0.05) << "from the first frames on";
  track(noise, 1.75, 100);
  EXPECT_NEAR(noise.factor(), 1.95, 0.05);
  track(noise, 0.88, 200);
  EXPECT_NEAR(noise.factor(), 1.0, 0.02);
}

TEST(DepthNoise, OneBadFrameSaysLittle) {
  DepthNoise noise(1.0);
  track(noise, 0.88, 60);
  track(noise, 3.5, 1);
  EXPECT_LT(noise.factor(), 1.1);
}

TEST(DepthNoise, IsBoundedAndIgnoresWhatIsNoNumber) {
  DepthNoise noise(1.0);
  track(noise, 100.0, 100);
  EXPECT_EQ(noise.factor(), 4.0);
  noise.learn(0.0);
  noise.learn(-1.0);
  EXPECT_EQ(noise.factor(), 4.0);
}

}  // namespace
}  // namespace rf
