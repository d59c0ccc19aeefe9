// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "segmentation/adjacency.hpp"
#include "segmentation/image_terms.hpp"
#include "segmentation/joint_solver.hpp"
#include "values/model_state.hpp"

namespace rf {

/// How the models speak in the choice of the scores.
struct MapEvidenceParams {
  double weight = 1.0;  ///< unary weight of a cluster that the models explain wholly, S_T = 1
  double intruder_share = 0.3;   ///< part of it for surfaces before the static model
  double sure_advantage = 1.0;   ///< log energy saved as a part of the body that outweighs the map
  double gate_m = 0.010;         ///< distance to a model's surface: this ...
  double gate_sigma = 3.0;       ///< ... plus this many depth sigmas (that of fusion's matching)
  double decision_weight = 4.0;  ///< of the models in the choice of the reading, image = 1
  double pixel_weight = 0.75;    ///< of a pixel's own witnesses against its cluster's score

  template <class V>
  void visit(V& v) {
    v("weight", weight, 0.0, 10.0, "-", "pull of a cluster that the models explain; 0 = off");
    v("intruder_share", intruder_share, 0.0, 1.0, "-",
      "part of it where something stands before the static model");
    v("pixel_weight", pixel_weight, 0.0, 1.0, "-",
      "of a pixel's own witnesses against its cluster's score; 0 = cluster masks");
    v("decision_weight", decision_weight, 0.0, 10.0, "-",
      "of the models in the choice of a frame's reading; 0 = off");
    v("sure_advantage", sure_advantage, 0.01, 100.0, "-",
      "log energy that a cluster saves as a part of the body at which the static model is silent");
    v("gate_m", gate_m, 1e-3, 1.0, "m", "distance to a model's surface that agrees with it");
    v("gate_sigma", gate_sigma, 0.0, 10.0, "sigma", "... plus this many sigmas of the depth");
  }
};

/// What both models look like from a recent camera M (ModelState): front-most stable surface.
struct MapView {
  Camera camera;
  Image<std::uint16_t> depth_mm;  ///< 0 = nothing
  Image<std::uint8_t> body;       ///< kBodyNone / kBodyStatic / kBodyObject
};

/// A reading of frame B against the models: its motions C_B -> C_M and its scores.
struct MapReading {
  SE3 T_MB_static, T_MB_object;
  const std::vector<float>* gamma = nullptr;  ///< per cluster
  double noise = 1;                           ///< factor on the sensor's sigma, of mapNoise
};

/// How far B's surface lies from the static model's under this motion, in sigmas of the sensor:
/// median over what both see, at least 1. A sensor that is noisier than its model must not make
/// bodies that are unknown look likelier than the world.
double mapNoise(const MapView& map, const TermLevel& b, const SE3& T_MB_static,
                const ImageTermParams& terms, const MapEvidenceParams& params);

/// Mean log energy per pixel of a reading's labels against the models' surfaces: a static pixel
/// pays for its distance to the static model, a dynamic one for that to the body's, at most
/// `outlier_margin` (bodies that are not known yet). Pixels where nothing is mapped pay nothing.
double mapEnergy(const MapView& map, const TermLevel& b, const Image<std::uint8_t>& label,
                 const MapReading& reading, const ImageTermParams& terms,
                 const MapEvidenceParams& params, double outlier_margin);

/// What the models say of one pixel.
enum class MapWitness : std::uint8_t { kNone, kStatic, kObject, kIntruder };

/// Each pixel of B against the models, given the motions C_B -> C_M of the static world and of the
/// body: on the static model's surface (kStatic), on the body's (kObject), or before the static
/// model's, where there was free space (kIntruder). Both or neither: kNone.
Image<MapWitness> mapWitnesses(const MapView& map, const Camera& camera, const Image<float>& depth,
                               const SE3& T_MB_static, const SE3& T_MB_object,
                               const ImageTermParams& terms, const MapEvidenceParams& params);

/// Adds the witnesses of each cluster to its unary term. `advantage` is the log energy that each
/// cluster saves as a part of the body: where it is large the motion has been seen, and what agrees
/// with the static model there is the place that the body has just left.
void addMapEvidence(const Image<MapWitness>& witnesses, const Image<std::uint8_t>& label,
                    const std::vector<double>& advantage, const MapEvidenceParams& params,
                    ScorePrior& scores);

/// Scores per pixel (255 * gamma): the cluster's, moved by the witnesses around the pixel on the
/// same surface. Mends clusters that reach over a contact (wheels and floor, hand and object).
/// Intruders only count in clusters that touch a dynamic one; `advantage` as above.
Image<std::uint8_t> refineScores(const Image<MapWitness>& witnesses, const Image<float>& depth,
                                 const Image<std::uint8_t>& label, const std::vector<float>& gamma,
                                 const std::vector<double>& advantage, const Adjacency& adjacency,
                                 const MapEvidenceParams& params);

}  // namespace rf
