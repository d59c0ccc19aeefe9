// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace rf {

/// Depth noise of the sensor, sigma_z = base + growth (z - near)^2, metres (algorithm of section
/// V).
struct SensorConfig {
  double sigma_base_m = 0.0012;
  double sigma_growth = 0.0019;
  double sigma_near_m = 0.4;
  double noise = 1.0;  ///< factor on sigma_z; where it is adapted, at the start
  bool adapt_noise = true;
  double depth_min_m = 0.3;
  double depth_max_m = 5.0;

  template <class V>
  void visit(V& v) {
    v("sigma_base_m", sigma_base_m, 1e-5, 0.1, "m", "depth noise at sigma_near_m");
    v("sigma_growth", sigma_growth, 0.0, 1.0, "1/m", "growth of the depth noise with (z - near)^2");
    v("sigma_near_m", sigma_near_m, 0.0, 5.0, "m", "depth at which the noise is sigma_base_m");
    v("noise", noise, 0.1, 10.0, "-", "factor on the depth noise");
    v("adapt_noise", adapt_noise, "-", "widen that factor by the residuals of tracked frames");
    v("depth_min_m", depth_min_m, 0.05, 5.0, "m", "nearer measurements are ignored");
    v("depth_max_m", depth_max_m, 0.5, 30.0, "m", "farther measurements are ignored");
  }
};

/// Frame-to-model alignment.
struct TrackingConfig {
  bool use_depth = true;
  bool use_intensity = true;
  std::string kernel = "cauchy";
  int levels = 3;
  int iterations_fine = 6;
  int iterations_coarse = 6;
  double stop_twist = 1e-4;
  double distance_m = 0.10;
  double coarse_distance = 0.5;
  double grazing_cos = 0.15;
  double sigma_floor_m = 0.001;
  double sigma_intensity = 0.03;
  double gradient_intensity = 0.25;
  double correlation = 10.0;
  double start_floor_m = 0.004;
  double start_floor_rad = 0.010;
  double start_inflation = 4.0;
  double min_inliers = 0.01;
  double min_inlier_share = 0.5;
  double min_visible_share = 0.25;
  double max_rms_sigma = 3.5;
  double max_chi = 5.0;
  double sure_inliers = 0.08;
  double sure_share = 0.7;
  double sure_rms_sigma = 2.5;
  double max_shift_m = 0.15;
  double max_turn_rad = 0.20;
  int min_object_pixels = 1000;
  double full_confidence = 0.95;

  template <class V>
  void visit(V& v) {
    v("use_depth", use_depth, "-", "point-to-plane rows");
    v("use_intensity", use_intensity, "-", "photometric rows");
    v("kernel", kernel, "-", "robust kernel of the whitened residuals: huber, tukey or cauchy");
    v("levels", levels, 1, 5, "-", "pyramid levels, each half the size of the one before");
    v("iterations_fine", iterations_fine, 0, 50, "-", "iterations at the finest level");
    v("iterations_coarse", iterations_coarse, 0, 50, "-", "iterations at every coarser level");
    v("stop_twist", stop_twist, 0.0, 0.1, "m, rad", "a level ends when the step is smaller");
    v("distance_m", distance_m, 0.01, 1.0, "m", "largest depth difference of a pair, finest level");
    v("coarse_distance", coarse_distance, 0.0, 10.0, "-",
      "distance_m grows by this factor of itself at each coarser level");
    v("grazing_cos", grazing_cos, 0.0, 0.9, "-", "surfaces seen flatter than this are not used");
    v("sigma_floor_m", sigma_floor_m, 0.0, 0.1, "m", "model error added to the depth noise");
    v("sigma_intensity", sigma_intensity, 1e-3, 1.0, "1", "noise of intensity, range 0..1");
    v("gradient_intensity", gradient_intensity, 0.0, 5.0, "px", "misplacement that adds noise");
    v("correlation", correlation, 1.0, 1000.0, "-",
      "correlated pixels: information is divided by it");
    v("start_floor_m", start_floor_m, 0.0, 1.0, "m", "least standard deviation of the start pose");
    v("start_floor_rad", start_floor_rad, 0.0, 1.0, "rad",
      "least standard deviation of the start pose");
    v("start_inflation", start_inflation, 0.0, 100.0, "-",
      "factor on the segmentation's covariance");
    v("min_inliers", min_inliers, 0.0, 1.0, "-", "accept: inliers per image pixel (static world)");
    v("min_inlier_share", min_inlier_share, 0.0, 1.0, "-", "accept: inliers per pair in view");
    v("min_visible_share", min_visible_share, 0.0, 1.0, "-",
      "accept: share of the model in view that nothing nearer hides");
    v("max_rms_sigma", max_rms_sigma, 0.5, 100.0, "sigma", "accept: whitened rms of the inliers");
    v("max_chi", max_chi, 1.0, 100.0, "sigma", "accept: distance from the start, Mahalanobis");
    v("sure_inliers", sure_inliers, 0.0, 1.0, "-",
      "with this many inliers per image pixel (and the two below) max_chi does not apply: the "
      "start "
      "is what is wrong");
    v("sure_share", sure_share, 0.0, 1.0, "-", "... and this inlier share");
    v("sure_rms_sigma", sure_rms_sigma, 0.1, 100.0, "sigma", "... and no larger whitened rms");
    v("max_shift_m", max_shift_m, 1e-3, 2.0, "m", "accept: translation from the start");
    v("max_turn_rad", max_turn_rad, 1e-3, 2.0, "rad", "accept: rotation from the start");
    v("min_object_pixels", min_object_pixels, 10, 1000000, "px",
      "least visible stable object pixels for tracking it (at 320x240; scales with the image)");
    v("full_confidence", full_confidence, 0.01, 0.999, "-",
      "static surfels count in full from here, younger ones by their confidence: they carry the "
      "error of the pose they were made at");
  }
};

/// Surfel map, prediction, update and cleaning.
struct SurfelConfig {
  double cell_m = 0.25;
  int max_surfels = 8000000;
  double radius_min_px = 0.7;
  double unstable_bias = 0.012;
  double rim_sigma = 8.5;
  double match_base_m = 0.010;
  double match_sigma = 3.0;
  double match_cos = 0.6;
  double initial_confidence = 0.10;
  double birth_confidence = 0.35;
  double stable_confidence = 0.25;
  double export_confidence = 0.5;
  bool export_remnants = false;
  double hit_log_odds = 0.25;
  double miss_log_odds = 1.0;
  double free_log_odds = 1.5;
  double free_base_m = 0.02;
  double free_sigma = 4.0;
  double remove_log_odds = -3.0;
  double max_log_odds = 4.6;
  double max_weight = 100.0;
  int unstable_age = 15;
  double append_cos = 0.15;

  template <class V>
  void visit(V& v) {
    v("cell_m", cell_m, 0.05, 5.0, "m", "side of a map cell");
    v("max_surfels", max_surfels, 1000, 100000000, "-", "per body; beyond it nothing is added");
    v("radius_min_px", radius_min_px, 0.5, 5.0, "px", "discs are drawn at least this large");
    v("unstable_bias", unstable_bias, 0.0, 0.2, "-",
      "relative depth by which unstable surfels yield");
    v("rim_sigma", rim_sigma, 0.0, 50.0, "sigma",
      "depth sigmas by which a disc's rim yields to others; half of that a pixel off the centre of "
      "a new disc: 3 sqrt(2), three sigma between two surfels that were measured once");
    v("match_base_m", match_base_m, 0.001, 0.2, "m", "association: distance to the disc's plane");
    v("match_sigma", match_sigma, 0.0, 10.0, "sigma", "association: plus this many depth sigmas");
    v("match_cos", match_cos, -1.0, 1.0, "-", "association: least cosine between the normals");
    v("initial_confidence", initial_confidence, 0.01, 0.9, "-", "of a new surfel");
    v("birth_confidence", birth_confidence, 0.01, 0.9, "-",
      "of the surfels of a model's first frame");
    v("stable_confidence", stable_confidence, 0.01, 0.95, "-", "a surfel is stable from here");
    v("export_confidence", export_confidence, 0.0, 0.99, "-", "exported from here");
    v("export_remnants", export_remnants, "-",
      "export what is left of a thing that has gone for the most part, too");
    v("hit_log_odds", hit_log_odds, 0.01, 5.0, "-", "confidence gained by a matching pixel");
    v("miss_log_odds", miss_log_odds, 0.0, 5.0, "-",
      "lost by a match that belongs to the other body");
    v("free_log_odds", free_log_odds, 0.0, 10.0, "-", "lost when the sensor looks through");
    v("free_base_m", free_base_m, 0.001, 0.5, "m", "looking through: surface behind by this");
    v("free_sigma", free_sigma, 0.0, 20.0, "sigma", "looking through: plus this many depth sigmas");
    v("remove_log_odds", remove_log_odds, -10.0, 0.0, "-", "removed below this confidence");
    v("max_log_odds", max_log_odds, 0.5, 20.0, "-", "confidence does not grow beyond");
    v("max_weight", max_weight, 1.0, 10000.0, "-", "averaging weight does not grow beyond");
    v("unstable_age", unstable_age, 1, 1000, "frames", "surfels still unstable then are removed");
    v("append_cos", append_cos, 0.0, 0.9, "-", "surfaces seen flatter than this are not added");
  }
};

/// Life cycle of the object model.
struct ObjectModelConfig {
  double birth_share = 0.03;
  int false_birth_frames = 4;
  double false_birth_m = 0.02;
  bool coast = true;
  double join_after_s = 0.0;
  double shared_m = 0.03;
  double onset_m = 0.08;
  int shared_every = 10;

  template <class V>
  void visit(V& v) {
    v("birth_share", birth_share, 0.001, 0.9, "-", "dynamic share of the valid pixels at birth");
    v("false_birth_frames", false_birth_frames, 0, 100, "frames",
      "a model that moved for no more frames than this is forgotten when it stops");
    v("false_birth_m", false_birth_m, 0.0, 1.0, "m", "... unless it moved farther than this");
    v("coast", coast, "-",
      "an object that segmentation does not see follows its prior and is looked for there");
    v("join_after_s", join_after_s, 0.0, 1e6, "s",
      "an object at rest for this long becomes part of the static map; 0: never");
    v("shared_m", shared_m, 0.0, 0.2, "m",
      "static surfels this near to the object's surface where it stood were the object; 0: stay");
    v("onset_m", onset_m, 0.0, 0.3, "m",
      "the same where it stood before its first motion: it is seen to move only after a while");
    v("shared_every", shared_every, 1, 1000, "frames", "how often they are looked for");
  }
};

/// Drift between surface that came back into view and what was mapped since (docs/ALGORITHM.md).
struct LoopConfig {
  bool close = true;
  double min_share = 0.05;
  double significance = 22.5;
  double plausible = 22.5;
  int confirm_frames = 3;
  double step_m = 0.002;
  double step_rad = 0.002;

  template <class V>
  void visit(V& v) {
    v("close", close, "-", "distribute the drift over what was mapped since");
    v("min_share", min_share, 0.001, 1.0, "-",
      "least share of the image of the surface that came back, and of the younger one");
    v("significance", significance, 0.0, 1e6, "-",
      "squared Mahalanobis distance between both from which on it is drift");
    v("plausible", plausible, 0.0, 1e6, "-",
      "and by the map's own uncertainty: beyond it is a mistake, not drift");
    v("confirm_frames", confirm_frames, 1, 100, "frames", "in a row that must say so");
    v("step_m", step_m, 1e-5, 1.0, "m", "most that the camera is moved a frame");
    v("step_rad", step_rad, 1e-5, 1.0, "rad", "most that the camera is turned a frame");
  }
};

/// Parameters of surfel fusion and frame-to-model tracking (paper section V).
struct FusionConfig {
  int reduction = 2;  ///< input pixels per model pixel
  SensorConfig sensor;
  TrackingConfig tracking;
  SurfelConfig surfels;
  ObjectModelConfig object;
  LoopConfig loop;

  template <class V>
  void visit(V& v) {
    v("reduction", reduction, 1, 8, "-", "input pixels per model pixel, both directions");
    v("sensor", sensor, "depth noise and range");
    v("tracking", tracking, "frame-to-model alignment");
    v("surfels", surfels, "surfel map");
    v("object", object, "life cycle of the object model");
    v("loop", loop, "drift against surface that came back into view");
  }
};

}  // namespace rf
