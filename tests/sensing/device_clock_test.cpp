// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/device_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rf {
namespace {

constexpr double kPeriodUs = 1e6 / 30;
constexpr double kLeastDelayUs = 2000;

/// A device whose clock runs wrong, behind a bus that delays each image by 2 ms and an
/// exponentially distributed rest of 3 ms on average.
class Sensor {
 public:
  struct Image {
    std::int64_t device_us, arrival_us, soonest_us;  ///< soonest: arrival without the rest
  };
  double drift = 0;  ///< system time runs 1 + drift while the device's runs 1
  double device = 7e6;
  double system = 1.7e15;

  Image next(double more_delay = 0) {
    device += kPeriodUs;
    system += kPeriodUs * (1 + drift);
    const double rest = std::exponential_distribution<double>(1 / 3000.0)(random_);
    return {std::llround(device), std::llround(system + kLeastDelayUs + rest + more_delay),
            std::llround(system + kLeastDelayUs)};
  }

 private:
  std::mt19937_64 random_{17};
};

constexpr int kMinute = 1800;
/// The smallest of 30 delays lies 0.1 ms above the least one on average.
constexpr double kCloseUs = 500;

double worstOf(DeviceClock& clock, Sensor& sensor, int images) {
  double worst = 0;
  for (int i = 0; i < images; ++i) {
    const auto image = sensor.next();
    const std::int64_t mapped = clock.observe(image.device_us, image.arrival_us);
    worst = std::max(worst, std::abs(static_cast<double>(mapped - image.soonest_us)));
  }
  return worst;
}

TEST(DeviceClock, JitterIsFilteredOut) {
  DeviceClock clock;
  Sensor sensor;
  worstOf(clock, sensor, 60);
  EXPECT_LT(worstOf(clock, sensor, 3 * kMinute), kCloseUs);
  EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, DriftIsFollowed) {
  for (const double drift : {-100e-6, 50e-6, 200e-6}) {
    DeviceClock clock;
    Sensor sensor;
    sensor.drift = drift;
    worstOf(clock, sensor, kMinute);
    EXPECT_LT(worstOf(clock, sensor, 20 * kMinute), kCloseUs) << drift;
    EXPECT_NEAR(clock.drift(), drift, 10e-6);
    EXPECT_EQ(clock.jumps(), 0);
  }
}

TEST(DeviceClock, ADriftThatChangesIsFollowed) {
  DeviceClock clock;
  Sensor sensor;
  worstOf(clock, sensor, kMinute);
  double worst = 0;
  for (int minute = 0; minute < 10; ++minute) {  // as a sensor warms up
    sensor.drift += 5e-6;
    worst = std::max(worst, worstOf(clock, sensor, kMinute));
  }
  EXPECT_LT(worst, 2 * kCloseUs);
}

TEST(DeviceClock, ABurstOfLateImagesMovesNothing) {
  DeviceClock clock;
  Sensor sensor;
  sensor.drift = 50e-6;
  worstOf(clock, sensor, kMinute);
  for (int i = 0; i < 30; ++i) {
    const auto late = sensor.next(400e3);
    EXPECT_NEAR(static_cast<double>(clock.observe(late.device_us, late.arrival_us)),
                static_cast<double>(late.soonest_us), kCloseUs);
  }
  EXPECT_LT(worstOf(clock, sensor, kMinute), kCloseUs);
  EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, APauseIsNoJump) {
  DeviceClock clock;
  Sensor sensor;
  worstOf(clock, sensor, kMinute);
  sensor.device += 5e6;
  sensor.system += 5e6;
  EXPECT_LT(worstOf(clock, sensor, kMinute), kCloseUs);
  EXPECT_EQ(clock.jumps(), 0);
}

TEST(DeviceClock, AJumpIsFollowedAndTimeStillIncreases) {
  for (const double jump : {-5e6, -1e6, 1e6, 3600e6}) {
    DeviceClock clock;
    Sensor sensor;
    worstOf(clock, sensor, kMinute);
    sensor.device += jump;
    std::int64_t last = 0;
    for (int i = 0; i < 300; ++i) {  // a jump back of the device shows after two seconds
      const auto image = sensor.next();
      const std::int64_t mapped = clock.observe(image.device_us, image.arrival_us);
      EXPECT_GT(mapped, last);
      last = mapped;
    }
    EXPECT_EQ(clock.jumps(), 1) << jump;
    EXPECT_LT(worstOf(clock, sensor, kMinute), kCloseUs) << jump;
  }
}

TEST(DeviceClock, StampsOf32BitMayWrap) {
  constexpr std::int64_t kWrap = std::int64_t{1} << 32;
  DeviceClock whole, wrapped;
  Sensor sensor;
  sensor.device = static_cast<double>(kWrap) - 20e6;
  for (int i = 0; i < 2 * kMinute; ++i) {
    const auto image = sensor.next();
    ASSERT_EQ(wrapped.observe(image.device_us % kWrap, image.arrival_us),
              whole.observe(image.device_us, image.arrival_us))
        << image.device_us;
    // The colour image of the pair may be from the other side of the wrap.
    const std::int64_t earlier = image.device_us - 5000;
    ASSERT_EQ(wrapped.map(earlier % kWrap), whole.map(earlier)) << earlier;
  }
  EXPECT_EQ(wrapped.jumps(), 0);
}

TEST(DeviceClock, MapsOtherStampsOfTheSameClock) {
  DeviceClock clock;
  EXPECT_EQ(clock.map(5), 5);
  const std::int64_t depth = clock.observe(1000, 900000);
  EXPECT_EQ(clock.map(3000), depth + 2000);
}

}  // namespace
}  // namespace rf
