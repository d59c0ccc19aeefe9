// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "mapping/prediction.hpp"
#include "mapping/surfel_map.hpp"

namespace rf {

/// Right perturbation at T_FC to left perturbation in F (T_FC exp(r) = exp(l) T_FC), and back.
Mat6 toLeft(const SE3& T_FC, const Mat6& right);
Mat6 toRight(const SE3& T_FC, const Mat6& left);

/// How uncertain a map is. A piece of surface is put where the camera was believed to be and moved
/// to the mean over all frames that see it; so it carries the mean error of their poses, and a
/// camera that aligns to it inherits that. Errors are kept as left perturbations in the body's
/// frame F: there the error of a piece is the same for every later camera. Errors of neighbouring
/// frames are nearly the same error, and the mean of fully correlated errors has at most the mean
/// of their covariances: that mean is what is kept, for pieces born in the same quarter second.
class MapUncertainty {
 public:
  /// Part of what is seen, by the time at which it was born.
  struct Share {
    std::size_t epoch = 0;
    double share = 0;  ///< the shares add up to 1
  };

  /// What the prediction shows, pixels counted by `weight` (0: not used). `map` is the one that was
  /// drawn, unchanged since.
  std::vector<Share> seen(const SurfelMap& map, const Prediction& prediction,
                          const Image<float>& weight) const;

  /// Covariance (left, frame F) of a camera that aligns without error to what is seen; the newest
  /// pieces' where nothing is; zero for an empty map.
  Mat6 of(const std::vector<Share>& seen) const;

  /// A frame with this counter (>= 0) and covariance (left, frame F) was fused: what it sees moves
  /// to the mean, what it adds has its error.
  void fuse(std::int32_t time, const std::vector<Share>& seen, const Mat6& covariance_F);

  /// When surfels of a frame counter were born.
  static std::size_t epochOf(std::int32_t time);
  /// Pieces of that time were out of view for two seconds and came back: what was mapped between
  /// may have drifted against them.
  bool cameBack(std::size_t epoch) const;

  /// The pieces' part in a drift (left perturbation, frame F) that was observed with this
  /// innovation covariance: P S^-1, errors being sums that all later pieces share. One matrix an
  /// epoch; zero for pieces that came back. Lowers their covariances to what is left when `share`
  /// of the correction is made.
  std::vector<Mat6> takeCorrection(const Mat6& innovation_F, double share);

 private:
  struct Epoch {
    Mat6 covariance_F = Mat6::Zero();
    double frames = 0;
    std::int32_t last_view = 0;
    bool came_back = false;
  };
  std::vector<Epoch> epochs_;
};

}  // namespace rf
