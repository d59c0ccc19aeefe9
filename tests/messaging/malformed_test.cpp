// SPDX-License-Identifier: BSD-3-Clause
// Every type that may be received, cut short, lengthened, and with bytes changed: never a crash,
// never an allocation by an unchecked size, always a reason.
#include <gtest/gtest.h>

#include "messaging/conversions.hpp"
#include "random_values.hpp"

namespace rf {
namespace {

template <class Message>
struct Sample;

#define RF_SAMPLE(type, expression)                           \
  template <>                                                 \
  struct Sample<type> {                                       \
    static Bytes make(RandomValues& r) { return expression; } \
  }
RF_SAMPLE(bot_core::images_t, pack(r.frame()));
RF_SAMPLE(rigidfusion::body_pose_t, pack(r.bodyPose()));
RF_SAMPLE(rigidfusion::camera_t, pack(r.camera()));
RF_SAMPLE(rigidfusion::command_t, pack(r.command()));
RF_SAMPLE(rigidfusion::frame_tick_t, pack(r.tick()));
RF_SAMPLE(rigidfusion::model_chunk_t, pack(r.chunk()));
RF_SAMPLE(rigidfusion::model_state_t, pack(r.modelState()));
RF_SAMPLE(rigidfusion::motion_prior_t, pack(r.prior()));
RF_SAMPLE(rigidfusion::segmentation_t, pack(r.segmentation()));
RF_SAMPLE(bot_core::pose_t, encodeMessage(*toBotPose({5, r.transform()})));
#undef RF_SAMPLE

template <class T>
class Malformed : public ::testing::Test {};

using Types =
    ::testing::Types<bot_core::images_t, bot_core::pose_t, rigidfusion::body_pose_t,
                     rigidfusion::camera_t, rigidfusion::command_t, rigidfusion::frame_tick_t,
                     rigidfusion::model_chunk_t, rigidfusion::model_state_t,
                     rigidfusion::motion_prior_t, rigidfusion::segmentation_t>;
TYPED_TEST_SUITE(Malformed, Types);

TYPED_TEST(Malformed, LayoutAgreesWithTheGeneratedDecoder) {
  RandomValues random(1);
  for (int i = 0; i < 20; ++i) {
    const Bytes bytes = Sample<TypeParam>::make(random);
    const auto message = decodeMessage<TypeParam>(bytes);
    ASSERT_TRUE(message) << message.error;
    EXPECT_EQ(encodeMessage(*message), bytes);
  }
}

TYPED_TEST(Malformed, EveryTruncationIsRefusedWithAReason) {
  RandomValues random(2);
  const Bytes bytes = Sample<TypeParam>::make(random);
  const std::size_t step = std::max<std::size_t>(1, bytes.size() / 500);
  for (std::size_t n = 0; n < bytes.size(); n += step) {
    const auto result = unpack<TypeParam>(ByteView(bytes).first(n));
    EXPECT_FALSE(result) << n;
    EXPECT_FALSE(result.error.empty());
  }
}

TYPED_TEST(Malformed, BytesTooManyAreRefused) {
  RandomValues random(3);
  Bytes bytes = Sample<TypeParam>::make(random);
  bytes.push_back(0);
  EXPECT_NE(decodeMessage<TypeParam>(bytes).error.find("too many"), std::string::npos);
}

TYPED_TEST(Malformed, ForeignHashIsNamed) {
  RandomValues random(4);
  Bytes bytes = Sample<TypeParam>::make(random);
  bytes[0] = static_cast<std::uint8_t>(bytes[0] ^ 0xFFU);
  EXPECT_NE(decodeMessage<TypeParam>(bytes).error.find("hash"), std::string::npos);
  EXPECT_FALSE(decodeMessage<TypeParam>(Bytes{}));
}

TYPED_TEST(Malformed, HugeAndNegativeCountsAreRefused) {
  RandomValues random(5);
  const Bytes good = Sample<TypeParam>::make(random);
  const std::size_t step = std::max<std::size_t>(1, good.size() / 2000);
  for (std::size_t at = 8; at + 4 <= good.size(); at += step) {
    for (const std::uint8_t high : {std::uint8_t{0x7F}, std::uint8_t{0xFF}}) {
      Bytes bad = good;
      bad[at] = high;
      for (std::size_t i = 1; i < 4; ++i) bad[at + i] = 0xFF;
      const auto result =
          unpack<TypeParam>(bad);  // may still be valid, must not crash or allocate much
      EXPECT_EQ(static_cast<bool>(result), result.error.empty());
    }
  }
}

TYPED_TEST(Malformed, RandomChangesNeverCrash) {
  RandomValues random(6);
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes = Sample<TypeParam>::make(random);
    for (int k = 0; k < 4; ++k) {
      bytes[static_cast<std::size_t>(
          random.integer(8, static_cast<std::int64_t>(bytes.size()) - 1))] =
          static_cast<std::uint8_t>(random.integer(0, 255));
    }
    const auto result = unpack<TypeParam>(bytes);
    EXPECT_EQ(static_cast<bool>(result), result.error.empty());
  }
}

}  // namespace
}  // namespace rf
