// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/depth_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rf {
namespace {

/// Frames of a sensor whose residuals against a settled map are `rms` of the model's own sigma.
void track(DepthNoise& noise, double rms, int frames, bool young_map = false) {
  for (int k = 1; k <= frames; ++k) {
    const double of_map = young_map ? std::sqrt(1.0 + 1.0 / k) : 1.0;
    noise.learn(rms * of_map / noise.factor());
  }
}

TEST(DepthNoise, AYoungMapIsNoNoise) {
  for (int frames = 1; frames < 40; ++frames) {
    DepthNoise fresh(1.0);
    track(fresh, 0.9, frames, true);
    EXPECT_EQ(fresh.factor(), 1.0) << frames << " frames";
  }
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
  track(noise, 1.75, 5, true);
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
