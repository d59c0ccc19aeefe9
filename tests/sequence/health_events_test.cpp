// SPDX-License-Identifier: BSD-3-Clause
// Events that a robot meets, injected into a cut of a simulated sequence: health reports them
// within five frames, comes back after them, and never calls a pose tracked that is 10 cm off.
#include <gtest/gtest.h>

#include <functional>

#include "evaluation/consistency.hpp"
#include "geometry/parallel.hpp"
#include "pipeline/offline.hpp"
#include "simulated_cut.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr int kFirst = 24;  // the object starts about frame 36
constexpr int kFrames = 60;
constexpr int kEvent = 25;      // first frame of the event, in the cut
constexpr int kReport = 5;      // frames until it must be reported
constexpr int kReturn = 10;     // frames at the end that must be tracked again
constexpr int kTeleport = 170;  // frames of the choreography in which the camera moves by 1 m
constexpr std::uint64_t kSeed = 43;

const sim::Simulator& simulator() {
  static const sim::Simulator instance("overtake", kSeed);
  return instance;
}

const SimulatedCut& undisturbed() {
  static const SimulatedCut instance = renderCut(simulator(), kFirst, kFrames, kSeed);
  return instance;
}

/// The cut with frames [kEvent, kEvent + count) changed.
SimulatedCut disturbed(int count, const std::function<void(RgbdFrame&)>& change) {
  SimulatedCut cut = undisturbed();
  for (int k = kEvent; k < kEvent + count; ++k) change(cut.frames[static_cast<std::size_t>(k)]);
  return cut;
}

void coverColour(RgbdFrame& f) { f.colour = Image<Rgb>(f.colour.width(), f.colour.height()); }
void coverDepth(RgbdFrame& f) {
  f.depth_mm = Image<std::uint16_t>(f.depth_mm.width(), f.depth_mm.height());
}

struct Watched {
  std::vector<BodyPose> camera;
  std::vector<double> error_m;  ///< of the camera's position, aligned at the first pose

  int misplaced() const {
    int n = 0;
    for (std::size_t k = 0; k < camera.size(); ++k) {
      n += camera[k].health == Health::kTracked && error_m[k] > kMisplaced ? 1 : 0;
    }
    return n;
  }
  /// Frames from the event's start until health says so; kFrames if never.
  int reportedAfter() const {
    for (int k = kEvent; k < kFrames; ++k) {
      if (camera[static_cast<std::size_t>(k)].health != Health::kTracked) return k - kEvent;
    }
    return kFrames;
  }
  bool is(int frame, Health health) const {
    return camera[static_cast<std::size_t>(frame)].health == health;
  }
};

Watched watch(const SimulatedCut& cut, bool with_prior = true) {
  setThreads(2);
  PipelineConfig config;
  PriorStage prior(config.prior);
  if (with_prior) prior.addCameraPoses(cut.camera_prior);
  prior.addObjectPoses(cut.object_prior);
  OfflinePipeline pipeline(config, simulator().world().camera, std::move(prior));
  Watched out;
  for (std::size_t k = 0; k < cut.frames.size(); ++k) {
    out.camera.push_back(pipeline.process(cut.frames[k]).state.camera);
    const SE3 world = cut.camera[0].pose * out.camera[0].T_W.inverse();
    out.error_m.push_back((world * out.camera[k].T_W.t - cut.camera[k].pose.t).norm());
  }
  setThreads(1);
  return out;
}

void expectTrackedAtTheEnd(const Watched& w) {
  for (int k = kFrames - kReturn; k < kFrames; ++k) {
    EXPECT_TRUE(w.is(k, Health::kTracked))
        << "frame " << k << ": " << name(w.camera[static_cast<std::size_t>(k)].health);
  }
}

TEST(HealthEvents, NothingIsReportedWhereNothingHappens) {
  const Watched w = watch(undisturbed());
  for (int k = 0; k < kFrames; ++k) EXPECT_TRUE(w.is(k, Health::kTracked)) << k;
  EXPECT_EQ(w.misplaced(), 0);
}

TEST(HealthEvents, ACoveredLensLeavesThePriorAlone) {
  constexpr int kCovered = 15;
  const Watched w = watch(disturbed(kCovered, [](RgbdFrame& f) {
    coverColour(f);
    coverDepth(f);
  }));
  EXPECT_LE(w.reportedAfter(), kReport);
  for (int k = kEvent + kReport; k < kEvent + kCovered; ++k) {
    EXPECT_TRUE(w.is(k, Health::kPriorOnly)) << k;
  }
  EXPECT_EQ(w.misplaced(), 0);
  expectTrackedAtTheEnd(w);
}

TEST(HealthEvents, ACoveredLensWithoutPriorIsLost) {
  constexpr int kCovered = 15;
  const Watched w = watch(disturbed(kCovered,
                                    [](RgbdFrame& f) {
                                      coverColour(f);
                                      coverDepth(f);
                                    }),
                          false);
  EXPECT_LE(w.reportedAfter(), kReport);
  for (int k = kEvent + kReport; k < kEvent + kCovered; ++k) {
    EXPECT_TRUE(w.is(k, Health::kLost)) << k;
  }
  EXPECT_EQ(w.misplaced(), 0);
}

TEST(HealthEvents, BlackPicturesDegradeWhileDepthTracksAlone) {
  constexpr int kBlack = 10;
  const Watched w = watch(disturbed(kBlack, coverColour));
  EXPECT_LE(w.reportedAfter(), kReport);
  for (int k = kEvent + kReport; k < kEvent + kBlack; ++k) {
    EXPECT_TRUE(w.is(k, Health::kDegraded)) << k;
    EXPECT_LT(w.error_m[static_cast<std::size_t>(k)], 0.05) << "depth holds the pose: " << k;
  }
  EXPECT_EQ(w.misplaced(), 0);
  expectTrackedAtTheEnd(w);
}

TEST(HealthEvents, WithoutDepthThePriorIsAlone) {
  constexpr int kGone = 15;
  const Watched w = watch(disturbed(kGone, coverDepth));
  EXPECT_LE(w.reportedAfter(), kReport);
  for (int k = kEvent + kReport; k < kEvent + kGone; ++k) {
    EXPECT_TRUE(w.is(k, Health::kPriorOnly)) << k;
  }
  EXPECT_EQ(w.misplaced(), 0);
  expectTrackedAtTheEnd(w);
}

TEST(HealthEvents, ATeleportThatThePriorDoesNotKnowIsNeverCalledTracked) {
  SimulatedCut cut = undisturbed();
  for (int k = kEvent; k < kFrames; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const sim::SimulatedFrame f = simulator().frame(kFirst + kTeleport + k);
    RgbdFrame frame = shown(f);
    frame.utime = frame.colour_utime = cut.frames[i].utime;
    frame.seq = k;
    cut.frames[i] = std::move(frame);
    cut.camera[i].pose = f.T_WC;
  }
  const double leap =
      (cut.camera[kEvent].pose.t - cut.camera[static_cast<std::size_t>(kEvent) - 1].pose.t).norm();
  ASSERT_GT(leap, 0.8);
  ASSERT_LT(leap, 1.3);
  const Watched w = watch(cut);
  EXPECT_LE(w.reportedAfter(), kReport);
  EXPECT_EQ(w.misplaced(), 0);
}

}  // namespace
}  // namespace rf
