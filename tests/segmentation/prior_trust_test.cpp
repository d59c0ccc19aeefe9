// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/prior_trust.hpp"

#include <gtest/gtest.h>

#include <random>

namespace rf {
namespace {

constexpr double kSigmaM = 0.002, kSigmaRad = 0.013;  // of an increment
constexpr double kSpeed = 0.01;                       // metres a frame
const SE3 kStep(Mat3::Identity(), Vec3(kSpeed, 0, 0));

Mat6 stated() { return covarianceOf({kSigmaM, kSigmaRad}); }

/// A camera that moves evenly, and a source of its motion.
class Source {
 public:
  explicit Source(const PriorTrustParams& params = {},
                  PriorTrust::Start start = PriorTrust::Start::kWord)
      : trust(params, start) {}
  void say(const SE3& increment, bool measured = true) {
    pose_ = pose_ * kStep;
    trust.observe({increment, stated(), measured, false}, pose_, follows_);
    follows_ = true;
  }
  PriorTrust trust;

 private:
  SE3 pose_;
  bool follows_ = false;
};

double translationScale(const PriorTrust& trust) {
  return trust.adapted(stated())(0, 0) / stated()(0, 0);
}

TEST(PriorTrust, AnHonestSourceKeepsItsCovariance) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    std::mt19937 bits(seed);
    std::normal_distribution<double> normal;
    Source source;
    for (int frame = 0; frame < 900; ++frame) {
      Vec6 e;
      for (double& x : e) x = normal(bits);
      e.head<3>() *= kSigmaM;
      e.tail<3>() *= kSigmaRad;
      source.say(kStep * SE3::exp(e));
      ASSERT_EQ(translationScale(source.trust), 1.0) << "seed " << seed << " frame " << frame;
      ASSERT_LT(source.trust.rotationFactor(), 4.0) << "seed " << seed << " frame " << frame;
    }
  }
}

TEST(PriorTrust, AFrozenSourceWidensWithinASecondAndRecovers) {
  Source source;
  for (int frame = 0; frame < 60; ++frame) source.say(kStep);
  EXPECT_EQ(translationScale(source.trust), 1.0);
  for (int frame = 0; frame < 30; ++frame) source.say(SE3());
  // 10 mm where 2 mm were stated, on one axis of three: the mean square is 25 / 3 of the stated.
  EXPECT_GT(translationScale(source.trust), 3.0);
  for (int frame = 0; frame < 300; ++frame) source.say(SE3());
  EXPECT_NEAR(translationScale(source.trust), 25.0 / 3.0, 1.0);
  EXPECT_EQ(source.trust.rotationFactor(), 1.0);
  for (int frame = 0; frame < 150; ++frame) source.say(kStep);
  EXPECT_EQ(translationScale(source.trust), 1.0);
}

TEST(PriorTrust, AGapIsNotAnInnovation) {
  Source source;
  for (int frame = 0; frame < 300; ++frame) source.say(SE3(), frame % 8 != 0);
  EXPECT_EQ(translationScale(source.trust), 1.0) << "no run of ten frames was measured";
}

TEST(PriorTrust, TheFactorIsBounded) {
  PriorTrustParams params;
  params.most = 50;
  Source source(params);
  for (int frame = 0; frame < 300; ++frame) source.say(SE3(Mat3::Identity(), Vec3(0, 1, 0)));
  EXPECT_DOUBLE_EQ(translationScale(source.trust), 50.0);
}

TEST(PriorTrust, WithoutItsWordTheFirstInnovationsAnswer) {
  Source known;
  Source unknown({}, PriorTrust::Start::kNothing);
  for (int frame = 0; frame < 7; ++frame) {
    known.say(SE3());
    unknown.say(SE3());
  }
  EXPECT_EQ(translationScale(known.trust), 1.0);
  EXPECT_NEAR(translationScale(unknown.trust), 25.0 / 3.0, 1.0);
}

TEST(PriorTrust, CanBeSwitchedOff) {
  PriorTrustParams params;
  params.adapt = false;
  Source source(params);
  for (int frame = 0; frame < 100; ++frame) source.say(SE3());
  EXPECT_EQ(source.trust.adapted(stated()), stated());
}

}  // namespace
}  // namespace rf
