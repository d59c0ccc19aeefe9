// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>

#include "geometry/se3.hpp"
#include "segmentation/prior_filter.hpp"

namespace rf {

/// How a prior's covariance follows its innovations (docs/ALGORITHM.md "Priors").
struct PriorTrustParams {
  bool adapt = true;
  int span = 10;       ///< frames of an innovation: drift has grown above tracking noise
  double memory = 30;  ///< frames over which innovations are averaged
  double clip = 9;     ///< an innovation counts for at most this much of what is expected: 3 sigma
  double most = 400;   ///< largest factor on a variance
  double noise_m = .002;  ///< of a pose that was tracked against the map
  double noise_rad = .003;

  template <class V>
  void visit(V& v) {
    v("adapt", adapt, "-", "whether a prior's covariance follows its innovations");
    v("span", span, 1, 100, "frames", "time over which prior and tracked poses are compared");
    v("memory", memory, 1.0, 10000.0, "frames", "time over which innovations are averaged");
    v("clip", clip, 1.0, 1000.0, "-", "most that one innovation counts, in expected ones");
    v("most", most, 1.0, 1e6, "-", "largest factor on a prior's variance");
    v("noise_m", noise_m, 0.0, 1.0, "m", "translation noise of tracked poses");
    v("noise_rad", noise_rad, 0.0, 1.0, "rad", "rotation noise of tracked poses");
  }
};

/// What a pose source is worth, by its innovations: the mean square of what is between its motion
/// over the last frames and that of the tracked poses, over what its covariance leads to expect,
/// for translation and rotation apart. Only ever widens: a covariance is believed until innovations
/// are twice as large as it says, so that an honest source keeps its own.
class PriorTrust {
 public:
  /// What the mean starts from: the source's own word, counted as a full memory of innovations, or
  /// nothing, where the first few have to answer, and half of their span is enough.
  enum class Start { kWord, kNothing };
  explicit PriorTrust(const PriorTrustParams& params, Start start = Start::kWord)
      : params_(params), start_(start), weighed_(start == Start::kWord ? params.memory : 0) {}

  /// One frame whose pose was tracked. `prior`: the source's increment from the frame before, with
  /// its own covariance; `pose`: the tracked pose that the increments lead along (T_WC, T_WO, or
  /// T_OC for kinematics). `follows`: the frame before was observed too.
  void observe(const Increment& prior, const SE3& pose, bool follows);

  /// Wider where the innovations ask for it; right perturbation, translation first.
  Mat6 adapted(const Mat6& covariance) const;

  double translationFactor() const { return factor(square_m_); }
  double rotationFactor() const { return factor(square_rad_); }
  /// Mean square of the translational innovations over the expected one.
  double translationSquare() const { return square_m_; }

 private:
  struct Step {
    Increment prior;
    SE3 pose;
  };
  /// 1 up to twice the expected square, all of it from four times on.
  double factor(double square) const;
  void average(double innovation, double& square) const;

  PriorTrustParams params_;
  Start start_;
  std::deque<Step> steps_;
  double weighed_;  ///< innovations that the means stand for, at most the memory
  double square_m_ = 1, square_rad_ = 1;
};

}  // namespace rf
