// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "kinematics/self_filter_config.hpp"
#include "segmentation/clusters.hpp"
#include "segmentation/hypotheses.hpp"
#include "segmentation/image_terms.hpp"
#include "segmentation/joint_solver.hpp"
#include "segmentation/map_evidence.hpp"
#include "segmentation/paper_config.hpp"
#include "segmentation/prior_trust.hpp"

namespace rf {

/// Parameters of motion segmentation (paper section IV). Defaults are for any scene;
/// docs/ALGORITHM.md gives the source of each.
struct SegmentationConfig {
  std::string mode = "rigidfusion";
  int reduction = 2;
  double min_depth_m = 0.3;
  double max_depth_m = 4.5;
  double min_depth_share = 0.05;
  int window_frames = 5;
  int settle_frames = 5;
  double window_s = 0.2;
  double window_rotation_rad = 0.2;
  int fine_iterations = 4;
  bool use_feedback = true;
  double camera_spread_m = 0.004;
  double camera_spread_rad = 0.010;
  double estimate_spread_m = 0.001;
  double estimate_spread_rad = 0.002;
  double object_spread_m = 0.002;
  double object_spread_rad = 0.006;
  double chain_spread_m = 0.005;
  double chain_spread_rad = 0.010;
  int mature_frames = 30;
  std::string object_prior_use = "all";
  double free_object_m = 0.05;
  double free_object_rad = 0.1;
  double lost_inlier_share = 0.01;
  double degraded_inlier_share = 0.04;
  ImageTermParams terms;
  JointParams joint;
  DecisionParams decision;
  MapEvidenceParams map;
  PriorTrustParams prior_trust;
  ClusterParams clusters;
  PaperConfig paper;
  SelfFilterConfig self_filter;

  template <class V>
  void visit(V& v) {
    v("mode", mode, "-", "rigidfusion | rigidfusion-paper | static | static-prior | vo");
    v("reduction", reduction, 1, 8, "-", "input pixels per working pixel, both directions");
    v("min_depth_m", min_depth_m, 0.0, 10.0, "m", "nearer measurements are ignored");
    v("max_depth_m", max_depth_m, 0.1, 60.0, "m", "farther measurements are ignored");
    v("min_depth_share", min_depth_share, 0.0, 1.0, "-",
      "least share of pixels with depth for an estimate");
    v("window_frames", window_frames, 1, 30, "frames", "how far back the reference frame may lie");
    v("settle_frames", settle_frames, 0, 30, "frames",
      "with an object prior: how long the mask stays where a body has come to rest; 0: it goes at "
      "once");
    v("window_s", window_s, 0.0, 2.0, "s",
      "how old the reference frame may be (if not the previous one)");
    v("window_rotation_rad", window_rotation_rad, 0.01, 1.0, "rad",
      "camera turn up to which frames overlap enough");
    v("fine_iterations", fine_iterations, 1, 20, "-", "iterations of the final solve");
    v("use_feedback", use_feedback, "-", "take over the poses that fusion refined");
    v("camera_spread_m", camera_spread_m, 1e-5, 1.0, "m",
      "change of camera velocity a frame, without a prior");
    v("camera_spread_rad", camera_spread_rad, 1e-5, 1.0, "rad",
      "change of camera turn rate a frame, without a prior");
    v("estimate_spread_m", estimate_spread_m, 1e-6, 1.0, "m",
      "error of an estimated step, without a prior");
    v("estimate_spread_rad", estimate_spread_rad, 1e-6, 1.0, "rad",
      "error of an estimated turn, without a prior");
    v("object_spread_m", object_spread_m, 1e-5, 1.0, "m",
      "change of object velocity a frame, prior rejected");
    v("object_spread_rad", object_spread_rad, 1e-5, 1.0, "rad",
      "change of object turn rate a frame, prior rejected");
    v("chain_spread_m", chain_spread_m, 0.0, 1.0, "m",
      "error of chained estimates that the models have not confirmed");
    v("chain_spread_rad", chain_spread_rad, 0.0, 1.0, "rad", "the same for turns");
    v("mature_frames", mature_frames, 0, 100000, "frames",
      "moving frames in which the camera prior agreed, from which on the models have a vote on "
      "whose motion is whose");
    v("object_prior_use", object_prior_use, "-",
      "all | start: not any more once the models have that vote | none");
    v("free_object_m", free_object_m, 1e-4, 1.0, "m",
      "object motion over the window without an object prior");
    v("free_object_rad", free_object_rad, 1e-4, 1.0, "rad",
      "object turn over the window without an object prior");
    v("lost_inlier_share", lost_inlier_share, 0.0, 1.0, "-",
      "inlier share of the image below which a body is not seen");
    v("degraded_inlier_share", degraded_inlier_share, 0.0, 1.0, "-",
      "inlier share below which a body is weakly seen");
    v("terms", terms, "image residuals");
    v("joint", joint, "joint solve of motions and scores");
    v("decision", decision, "competing readings of a frame");
    v("map", map, "what the models say of the scores");
    v("prior_trust", prior_trust, "how priors are judged by their innovations");
    v("clusters", clusters, "K-means clusters");
    v("paper", paper, "modes that follow the publications");
    v("self_filter", self_filter, "the robot's own links in the picture");
  }
};

}  // namespace rf
