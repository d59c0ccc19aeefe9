// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_writer.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "robot_writer.hpp"
#include "text_files.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

constexpr double kStaticSpacing = 0.01;
constexpr double kBodySpacing = 0.005;
constexpr int kSurfaceStride = 5;     // every fifth frame is asked what it shows
constexpr int kSurfaceMinFrames = 3;  // and so many of those must show a point

void writeImage(const fs::path& file, const cv::Mat& image) {
  // No level given: OpenCV then takes its fast path, one row filter and run lengths. Any level
  // makes libpng try every filter on every row, a seventh of the whole simulator for 3 % smaller
  // files.
  bool written = false;
  try {
    written = cv::imwrite(file.string(), image);
  } catch (const cv::Exception& e) {
    throw std::runtime_error(file.string() + ": " + e.what());
  }
  if (!written) throw std::runtime_error(file.string() + ": cannot be written");
}

template <typename T>
cv::Mat copied(const Image<T>& image, int type) {
  cv::Mat mat(image.height(), image.width(), type);
  std::memcpy(mat.data, image.data(), image.size() * sizeof(T));
  return mat;
}

cv::Mat bgr(const Image<Rgb>& image) {
  cv::Mat mat = copied(image, CV_8UC3);
  cv::cvtColor(mat, mat, cv::COLOR_RGB2BGR);
  return mat;
}

std::string trajectoryText(const char* what, const std::vector<DriftPose>& poses) {
  std::string text = fmt::format("# {}\n# timestamp tx ty tz qx qy qz qw\n", what);
  for (const auto& [utime, pose] : poses) text += tumLine(utime, pose);
  return text;
}

void writePly(const fs::path& file, const std::vector<sim::SurfacePoint>& points) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nend_header\n",
      points.size());
  const std::size_t header = text.size();
  text.resize(header + points.size() * 24);
  char* at = text.data() + header;
  for (const sim::SurfacePoint& p : points) {
    std::memcpy(at, p.position.data(), 12);
    std::memcpy(at + 12, p.normal.data(), 12);
    at += 24;
  }
  writeText(file, text);
}

}  // namespace

SequenceWriter::SequenceWriter(fs::path folder, const sim::World& world, SequenceOptions options)
    : folder_(std::move(folder)),
      world_(world),
      options_(options),
      samples_(world, kStaticSpacing, kBodySpacing) {
  for (const char* sub : {"rgb", "depth", "mask"}) fs::create_directories(folder_ / sub);
}

void SequenceWriter::add(const sim::SimulatedFrame& frame) {
  const std::string name = stampText(frame.utime) + ".png";
  writeImage(folder_ / "rgb" / name, bgr(frame.colour));
  writeImage(folder_ / "depth" / name, copied(frame.depth, CV_16UC1));
  writeImage(folder_ / "mask" / name, copied(frame.mask, CV_8UC1));
  if (entries_.size() % kSurfaceStride == 0) samples_.see(frame);
  const auto valid =
      static_cast<double>(frame.mask.size()) -
      static_cast<double>(std::count(frame.mask.begin(), frame.mask.end(), std::uint8_t{0}));
  const auto object =
      static_cast<double>(std::count(frame.mask.begin(), frame.mask.end(), std::uint8_t{2}));
  entries_.push_back({frame.utime, frame.T_WC, frame.T_WB, frame.object_speed_mps,
                      valid > 0 ? object / valid : 0.0,
                      valid / static_cast<double>(frame.mask.size())});
}

void SequenceWriter::finish() {
  writeLists();
  writePoses();
  writePriors();
  writeSurfaces();
  if (world_.robot) writeRobot(folder_ / "robot", world_, options_.drift_seed);
}

void SequenceWriter::writeLists() const {
  std::string rgb = "# color images\n# timestamp filename\n";
  std::string depth = "# depth maps\n# timestamp filename\n";
  std::string motion = "# timestamp object_speed_m_per_s object_share_of_valid valid_share\n";
  for (const Entry& e : entries_) {
    const std::string s = stampText(e.utime);
    rgb += fmt::format("{0} rgb/{0}.png\n", s);
    depth += fmt::format("{0} depth/{0}.png\n", s);
    motion +=
        fmt::format("{} {:.4f} {:.4f} {:.4f}\n", s, e.object_speed, e.object_share, e.valid_share);
  }
  writeText(folder_ / "rgb.txt", rgb);
  writeText(folder_ / "depth.txt", depth);
  writeText(folder_ / "object_motion.txt", motion);
  const Camera& c = world_.camera;
  writeText(folder_ / "camera.yaml",
            fmt::format("width: {}\nheight: {}\nfx: {}\nfy: {}\ncx: {}\ncy: {}\ndepth_factor: {}\n",
                        c.width, c.height, c.fx, c.fy, c.cx, c.cy, sim::kDepthFactor));
}

void SequenceWriter::writePoses() const {
  std::vector<DriftPose> camera;
  for (const Entry& e : entries_) camera.emplace_back(e.utime, e.T_WC);
  writeText(folder_ / "groundtruth.txt", trajectoryText("true T_WC of the camera", camera));
  for (int body = 1; body < sim::firstRobotBody(world_); ++body) {
    std::vector<DriftPose> poses;
    for (const Entry& e : entries_) {
      poses.emplace_back(e.utime, e.T_WB[static_cast<std::size_t>(body)]);
    }
    const std::string name = body == 1 ? "object" : fmt::format("object{}", body);
    writeText(folder_ / (name + "_groundtruth.txt"),
              trajectoryText("true T_WO of the object", poses));
  }
}

void SequenceWriter::writePriors() const {
  if (world_.robot) return;  // the robot's own recordings are the priors
  std::vector<DriftPose> camera;
  std::vector<DriftPose> object;
  for (const Entry& e : entries_) {
    camera.emplace_back(e.utime, e.T_WC);
    if (world_.bodies > 1) object.emplace_back(e.utime, e.T_WB[1]);
  }
  const auto drifted = [&](const std::vector<DriftPose>& truth, const PriorDrift& d,
                           DriftStream stream) {
    return addDrift(truth, {d.translation_mps, d.rotation_radps, options_.drift_seed, stream});
  };
  if (options_.camera) {
    writeText(folder_ / "odometry.txt",
              trajectoryText("T_WC of the camera with simulated drift",
                             drifted(camera, *options_.camera, DriftStream::kCamera)));
  }
  if (options_.object && !object.empty()) {
    writeText(folder_ / "object_odometry.txt",
              trajectoryText("T_WO of the object with simulated drift",
                             drifted(object, *options_.object, DriftStream::kObject)));
  }
}

void SequenceWriter::writeSurfaces() const {
  const auto have = static_cast<int>((entries_.size() + kSurfaceStride - 1) / kSurfaceStride);
  const int need = std::min(kSurfaceMinFrames, std::max(1, have));
  writePly(folder_ / "surface.ply", samples_.seen(0, need));
  if (world_.bodies > 1) writePly(folder_ / "object_surface.ply", samples_.seen(1, need));
}

}  // namespace rf
