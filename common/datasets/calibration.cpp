// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/calibration.hpp"

#include <fstream>
#include <limits>
#include <vector>

#include "config/yaml.hpp"
#include "datasets/error.hpp"

namespace rf {
namespace {

constexpr double kUnset = -std::numeric_limits<double>::max();

struct CalibrationFile {
  int width = 0;
  int height = 0;
  double fx = kUnset, fy = kUnset, cx = kUnset, cy = kUnset, depth_factor = kUnset;
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;

  template <class V>
  void visit(V& v) {
    v("width", width, 16, kMaxImageSide, "px", "image width");
    v("height", height, 16, kMaxImageSide, "px", "image height");
    v("fx", fx, 1.0, 1e5, "px", "focal length, horizontal");
    v("fy", fy, 1.0, 1e5, "px", "focal length, vertical");
    v("cx", cx, 0.0, kMaxImageSide, "px", "principal point, pixel centres are whole numbers");
    v("cy", cy, 0.0, kMaxImageSide, "px", "principal point");
    v("depth_factor", depth_factor, 1.0, 1e6, "1/m", "depth units of the files per metre");
    v("k1", k1, -100.0, 100.0, "-", "radial distortion (Brown-Conrady, OpenCV order)");
    v("k2", k2, -100.0, 100.0, "-", "radial distortion");
    v("p1", p1, -10.0, 10.0, "-", "tangential distortion");
    v("p2", p2, -10.0, 10.0, "-", "tangential distortion");
    v("k3", k3, -100.0, 100.0, "-", "radial distortion");
  }
};

void requireAll(const std::string& path, const CalibrationFile& f) {
  const std::vector<std::pair<const char*, bool>> given = {
      {"width", f.width != 0},
      {"height", f.height != 0},
      {"fx", f.fx != kUnset},
      {"fy", f.fy != kUnset},
      {"cx", f.cx != kUnset},
      {"cy", f.cy != kUnset},
      {"depth_factor", f.depth_factor != kUnset}};
  for (const auto& [name, is_given] : given) {
    if (!is_given) throw DatasetError(path + ": " + name + ": is missing");
  }
}

}  // namespace

Calibration readCalibration(const std::string& path) {
  CalibrationFile f;
  loadConfigFile(path, f);
  requireAll(path, f);
  Calibration calibration;
  calibration.camera = {f.width, f.height, f.fx, f.fy, f.cx, f.cy, {f.k1, f.k2, f.p1, f.p2, f.k3}};
  calibration.depth_factor = f.depth_factor;
  if (const auto problem = calibration.camera.problem()) throw DatasetError(path + ": " + *problem);
  return calibration;
}

void writeCalibration(const std::string& path, const Calibration& calibration) {
  const Camera& c = calibration.camera;
  CalibrationFile f{c.width, c.height, c.fx, c.fy, c.cx, c.cy, calibration.depth_factor};
  f.k1 = c.distortion[0];
  f.k2 = c.distortion[1];
  f.p1 = c.distortion[2];
  f.p2 = c.distortion[3];
  f.k3 = c.distortion[4];
  std::ofstream file(path, std::ios::trunc);
  file << writeConfig(f) << std::flush;
  if (!file) throw DatasetError(path + ": cannot be written");
}

}  // namespace rf
