// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "segmentation/joint_solver.hpp"
#include "segmentation/map_evidence.hpp"

namespace rf {

/// Charges and sizes of the decision; each in negative log likelihood units (docs/ALGORITHM.md).
struct DecisionParams {
  int iterations = 4;            ///< of each short coarse solve
  int dominant_iterations = 6;   ///< of the fit of all pixels
  double dominant_prior = 0.05;  ///< weight left to the camera prior in that fit
  double switch_charge =
      0.02;  ///< share of h0's image energy that every other two-body reading pays
  double one_body_bonus = 12;   ///< two bodies must explain this much more than one
  double known_body_bonus = 6;  ///< the same where the body's reading has lasted (lasted_frames)
  /// A body that nothing announced must explain the images better by this share: measured, true
  /// motion gains 15 to 65 % of one body's image energy, clusters that fit badly 3 to 12.
  double first_body_share = 0.1;
  double no_static_charge = 8;  ///< paid by a state that leaves (almost) no static pixels
  double no_static_share = 0.03;
  double body_dominant_charge = 6;  ///< without an object prior: the camera prior must be this sure
                                    ///< that the dominant motion is not the world's (odds of 400)
  /// No prior that tells: times the log odds of a new body against its world, by pixels. At 60 % of
  /// the view again odds of 400.
  double small_world_charge = 15;
  /// No prior that tells: times the log odds of a new body that is the farther side of its border,
  /// by pixels. From 45 to 90 all starts of `overtake` are read right, at 30 four of five.
  double body_behind_charge = 60;
  /// How long a reading that takes the body of the frame before for the world has to win: the drift
  /// of odometry is alike for about a second (algorithm B.6), so fewer frames are one witness.
  /// Where a prior tells, half as long as the world was undisputed, at most this.
  int turn_frames = 30;
  /// A reading that held for so long outlives a rest: what starts next is the same body. Two
  /// seconds, as fusion's (turned_reading.hpp).
  int lasted_frames = 60;
  double weak_pull = 0.3;          ///< unary weight to 0.5 where labels are unknown
  double reference_pixels = 4800;  ///< the charges were found at 80x60

  template <class V>
  void visit(V& v) {
    v("iterations", iterations, 1, 50, "-", "iterations of each short coarse solve");
    v("dominant_iterations", dominant_iterations, 1, 50, "-",
      "iterations of the one-motion fit of all pixels");
    v("dominant_prior", dominant_prior, 0.0, 1.0, "-",
      "weight left to the camera prior in that fit");
    v("switch_charge", switch_charge, 0.0, 1.0, "-",
      "share of the image energy that a changed reading pays");
    v("one_body_bonus", one_body_bonus, 0.0, 1000.0, "nll",
      "what two bodies must explain beyond one");
    v("known_body_bonus", known_body_bonus, 0.0, 1000.0, "nll",
      "what two bodies must explain beyond one where the body's reading has lasted");
    v("first_body_share", first_body_share, 0.0, 1.0, "-",
      "share of one body's image energy that an unannounced body must save");
    v("no_static_charge", no_static_charge, 0.0, 1000.0, "nll",
      "paid by a state without static pixels");
    v("no_static_share", no_static_share, 0.0, 0.5, "-",
      "static share below which that charge falls due");
    v("body_dominant_charge", body_dominant_charge, 0.0, 1000.0, "nll",
      "without an object prior: paid for reading the dominant motion as the body's");
    v("small_world_charge", small_world_charge, 0.0, 1000.0, "nll",
      "no prior that tells: paid by a new body larger than its world, times the log odds of it");
    v("body_behind_charge", body_behind_charge, 0.0, 1000.0, "nll",
      "no prior that tells: paid by a new body behind its world, times the log odds of it");
    v("turn_frames", turn_frames, 1, 100, "frames",
      "for how long mask and world must be read the other way round to be turned, where no prior "
      "tells; where one does half as long as they were undisputed, at most this");
    v("lasted_frames", lasted_frames, 1, 10000, "frames",
      "from when on a rest does not end the reading of a body");
    v("weak_pull", weak_pull, 0.0, 10.0, "-", "pull of scores whose labels are unknown");
    v("reference_pixels", reference_pixels, 1.0, 1e7, "px",
      "pixels that the image energy counts for");
  }
};

/// What is known before the decision.
struct DecisionInput {
  JointLevel level;              ///< the coarse level
  JointState continued;          ///< chained estimate plus one prior step, gamma = warped scores
  JointPrior step_prior;         ///< around the chained estimate: one step's covariance
  JointPrior window_prior;       ///< product of accepted prior increments over the window
  ScorePrior warped;             ///< S_T
  bool body_seen = false;        ///< Decision::body_seen of the frame before
  bool body_moved = false;       ///< two bodies were read in the frame before
  int moved_frames = 0;          ///< for so many frames, mask and world the same way round
  int turned_frames = 0;         ///< Decision::turned_frames of the frame before
  bool camera_measured = false;  ///< the camera prior comes from a source, not from its own past
  bool camera_tells = false;     ///< it is a witness of which body is the world
  const Adjacency* adjacency = nullptr;
  const MapView* map = nullptr;  ///< both models, if they are known
  SE3 T_MA_static, T_MA_object;  ///< C_A -> C_M of the static world and of the body
};

/// The winning reading of the frame.
struct Decision {
  std::string name;        ///< continue, camera-dominant, object-dominant, between, swap, restart,
                           ///< one-body, outliers
  JointFit fit;            ///< at the coarse level
  bool continued = false;  ///< the step prior (not the window's) belongs to it
  bool body_seen = false;  ///< two bodies won, though one may be taken until they win again
  int turned_frames = 0;   ///< how often in a row mask and world were read the other way round
  bool turned = false;     ///< and now it is so: without an object prior, against the frame before
};

/// Competing readings of which motion is whose, each solved briefly at the coarse level; the lowest
/// energy (image plus window priors plus charges) wins. The two readings of the dominant motion are
/// what finds an object that covers most of the view (algorithm G, Q2). A body without prior and
/// mature model has to earn it: in the images (not by the camera prior's cost, which makes the
/// whole view a body where odometry is off), beside a world that stays, in two frames in a row.
Decision decide(const DecisionInput& input, const JointParams& params,
                const DecisionParams& decision, const ImageTermParams& terms,
                const MapEvidenceParams& map);

}  // namespace rf
