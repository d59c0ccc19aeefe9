// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/pairing.hpp"

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr std::int64_t kMaxGap = 20000;

/// Feeds 'D' and 'C' images with times in milliseconds; what is decided, as "D0+C4 D33-: D66+C70".
class Feed {
 public:
  Feed& depth(std::int64_t ms) {
    note(pairer_.add(DepthImage{ms * 1000, 0, {}}));
    return *this;
  }
  Feed& colour(std::int64_t ms) {
    note(pairer_.add(ColourImage{ms * 1000, {}}));
    return *this;
  }
  std::string finish() {
    note(pairer_.finish());
    return text_;
  }
  const std::string& text() const { return text_; }

 private:
  void note(const std::vector<ImagePair>& pairs) {
    for (const ImagePair& pair : pairs) {
      text_ += (text_.empty() ? "D" : " D") + std::to_string(pair.depth.device_us / 1000);
      text_ += pair.colour ? "+C" + std::to_string(pair.colour->device_us / 1000) : "-";
      EXPECT_EQ(pair.problem.empty(), pair.colour.has_value());
      if (!pair.colour) continue;
      EXPECT_EQ(pair.gap_us, pair.colour->device_us - pair.depth.device_us);
    }
  }

  FramePairer pairer_{kMaxGap};
  std::string text_;
};

TEST(Pairing, ColourJustAfterDepthDecidesAtOnce) {
  Feed feed;
  feed.depth(0);
  EXPECT_EQ(feed.text(), "");
  feed.colour(4);
  EXPECT_EQ(feed.text(), "D0+C4");
}

TEST(Pairing, ColourBeforeDepthWaitsForANearerOne) {
  Feed feed;
  feed.colour(0).depth(15);
  EXPECT_EQ(feed.text(), "");
  EXPECT_EQ(feed.colour(18).text(), "D15+C18");
}

TEST(Pairing, TheSameTimeDecidesAtOnce) {
  EXPECT_EQ(Feed().colour(10).depth(10).text(), "D10+C10");
}

TEST(Pairing, ADroppedColourImageCostsOneFrame) {
  EXPECT_EQ(Feed().depth(0).colour(4).depth(33).depth(66).colour(70).text(), "D0+C4 D33- D66+C70");
}

TEST(Pairing, ADroppedDepthImageCostsNothingElse) {
  EXPECT_EQ(Feed().depth(0).colour(4).colour(37).depth(66).colour(70).text(), "D0+C4 D66+C70");
}

TEST(Pairing, ALateColourImageIsStillPaired) {
  EXPECT_EQ(Feed().depth(0).depth(33).colour(4).colour(37).text(), "D0+C4 D33+C37");
}

TEST(Pairing, WithoutColourDepthIsGivenUpAfterTwoMore) {
  EXPECT_EQ(Feed().depth(0).depth(33).depth(66).text(), "D0-");
}

TEST(Pairing, SlowColourServesTwo) {
  EXPECT_EQ(Feed().colour(0).depth(1).depth(18).colour(66).text(), "D1+C0 D18+C0");
}

TEST(Pairing, TheGapIsBoundedAndSaid) {
  FramePairer pairer(kMaxGap);
  pairer.add(DepthImage{0, 0, {}});
  const auto pairs = pairer.add(ColourImage{kMaxGap + 1, {}});
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_FALSE(pairs[0].colour);
  EXPECT_NE(pairs[0].problem.find("max_pair_gap"), std::string::npos) << pairs[0].problem;
}

TEST(Pairing, ColourBeforeDepthByLessThanHalfThePeriodDecidesAtOnce) {
  FramePairer pairer(kMaxGap, 33333);
  pairer.add(ColourImage{0, {}});
  EXPECT_EQ(pairer.add(DepthImage{14000, 0, {}}).size(), 1U);
  pairer.add(ColourImage{33000, {}});
  EXPECT_TRUE(pairer.add(DepthImage{33000 + 17000, 0, {}}).empty()) << "the next may be nearer";
}

TEST(Pairing, TheEndDecidesTheRest) {
  EXPECT_EQ(Feed().colour(0).depth(5).finish(), "D5+C0");
  EXPECT_EQ(Feed().depth(5).finish(), "D5-");
}

TEST(Pairing, TimeThatGoesBackForgetsWhatWasBefore) {
  EXPECT_EQ(Feed().depth(9000).depth(9033).depth(0).colour(4).text(), "D9000- D9033- D0+C4");
}

}  // namespace
}  // namespace rf
