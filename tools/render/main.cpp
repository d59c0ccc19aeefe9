// SPDX-License-Identifier: BSD-3-Clause
// rf-render: pictures of a result that a person understands at once.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "datasets/ply.hpp"
#include "datasets/text.hpp"
#include "datasets/trajectory.hpp"
#include "datasets/tum.hpp"
#include "models.hpp"
#include "plot.hpp"
#include "result.hpp"
#include "sheet.hpp"

namespace {

namespace fs = std::filesystem;
using namespace rf;
using namespace rf::render;

struct Options {
  std::string sequence;
  std::string result;
  std::string output;
  std::string camera_prior;
  std::string object_prior;
  std::string title;
};

/// Path of `name` in the folder when it exists, else empty.
std::string existing(const std::string& folder, const std::string& name) {
  const fs::path path = fs::path(folder) / name;
  return !folder.empty() && fs::exists(path) ? path.string() : std::string();
}

Trajectory readIfThere(const std::string& path) {
  return path.empty() ? Trajectory() : readTrajectory(path);
}

std::vector<SurfelPoint> readModel(const std::string& path) {
  return path.empty() ? std::vector<SurfelPoint>() : readPly(path);
}

/// The prior that the run wrote down (with its simulated drift), else the named one, else the
/// sequence's own.
Trajectory readPrior(const Options& options, const std::string& named, const std::string& recorded,
                     const std::string& own) {
  if (named == "none") return {};
  if (!named.empty()) return readTrajectory(named);
  const std::string written = existing(options.result, recorded);
  return readIfThere(written.empty() ? existing(options.sequence, own) : written);
}

cv::Mat bgr(const Image<Rgb>& image) {
  const cv::Mat rgb(image.height(), image.width(), CV_8UC3,
                    const_cast<Rgb*>(image.data()));  // read only
  cv::Mat out;
  cv::cvtColor(rgb, out, cv::COLOR_RGB2BGR);
  return out;
}

cv::Mat grey(const Image<std::uint8_t>& image) {
  return cv::Mat(image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data()))
      .clone();
}

SheetFrame sheetFrame(const TumDataset& dataset, std::size_t i, const Options& options,
                      const std::map<std::int64_t, FrameRow>& rows) {
  const TumEntry& entry = dataset.index().frames[i];
  const Camera& camera = dataset.calibration().camera;
  SheetFrame frame;
  frame.colour = bgr(readColourImage(entry.colour_path, camera.width, camera.height));
  frame.seq = static_cast<std::int64_t>(i);
  frame.time_s = static_cast<double>(entry.utime - dataset.index().frames.front().utime) * 1e-6;
  const std::string mask =
      existing(options.result, "masks/" + formatTimestamp(entry.utime) + ".png");
  if (!mask.empty()) frame.mask = grey(readGreyImage(mask, camera.width, camera.height));
  if (const auto row = rows.find(entry.utime); row != rows.end()) {
    frame.health = row->second.health;
    if (row->second.has_share) frame.dynamic_share = row->second.dynamic_share;
  }
  return frame;
}

void save(const Options& options, const std::string& name, const cv::Mat& picture) {
  const std::string path = (fs::path(options.output) / name).string();
  if (!cv::imwrite(path, picture)) throw DatasetError(path + ": cannot be written");
  fmt::print("{}\n", path);
}

void drawSheet(const Options& options) {
  if (options.sequence.empty()) {
    fmt::print(stderr, "rf-render: no contact sheet: no --sequence given\n");
    return;
  }
  const TumDataset dataset(options.sequence);
  const std::string table = existing(options.result, "frames.csv");
  const auto rows = table.empty() ? std::map<std::int64_t, FrameRow>() : readFrameRows(table);
  std::vector<SheetFrame> frames;
  for (const std::size_t i : spreadOver(dataset.size(), 12)) {
    try {
      frames.push_back(sheetFrame(dataset, i, options, rows));
    } catch (const DatasetError& e) {
      fmt::print(stderr, "rf-render: frame {} left out: {}\n", i, e.what());
    }
  }
  save(options, "contact_sheet.png",
       contactSheet(frames, options.title + ": segmentation of the frames"));
}

std::optional<Vec3> centreOf(const std::vector<SurfelPoint>& surfels) {
  if (surfels.empty()) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  for (const SurfelPoint& s : surfels) sum += Vec3(s.x, s.y, s.z);
  return Vec3(sum / static_cast<double>(surfels.size()));
}

void drawTrajectories(const Options& options, const Tracks& estimate,
                      const std::vector<SurfelPoint>& object) {
  const Tracks truth{readIfThere(existing(options.sequence, "groundtruth.txt")),
                     readIfThere(existing(options.sequence, "object_groundtruth.txt"))};
  const Tracks prior{
      readPrior(options, options.camera_prior, "camera_prior.txt", "odometry.txt"),
      readPrior(options, options.object_prior, "object_prior.txt", "object_odometry.txt")};
  const Overlaid lines = overlayTracks(truth, prior, estimate, centreOf(object));
  const bool with_truth = !truth.camera.empty();
  save(options, "trajectories.png",
       trajectoryPlot(lines.series, lines.plane, options.title + ": paths seen from above",
                      with_truth ? "all lines aligned to the truth at the camera's first pose"
                                 : "no true trajectory is known; frame of the estimate"));
}

void drawModels(const Options& options, const Tracks& estimate,
                const std::vector<SurfelPoint>& object) {
  const ModelScene scene{readModel(existing(options.result, "static.ply")), object, estimate.camera,
                         estimate.object};
  if (scene.world.empty() || scene.camera.empty()) {
    fmt::print(stderr, "rf-render: no picture of the models: the result has no static surfels\n");
    return;
  }
  save(options, "models.png", modelPicture(scene, options.title + ": surfel models"));
}

int run(Options options) {
  if (!fs::is_directory(options.result)) throw DatasetError(options.result + ": is no folder");
  if (options.output.empty()) options.output = options.result;
  fs::create_directories(options.output);
  if (options.title.empty() && !options.sequence.empty()) {
    options.title = fs::weakly_canonical(options.sequence).filename().string();
  }
  if (options.title.empty()) options.title = "RigidFusion";
  const Tracks estimate{readIfThere(existing(options.result, "camera.txt")),
                        readIfThere(existing(options.result, "object.txt"))};
  const auto object = readModel(existing(options.result, "object.ply"));
  drawSheet(options);
  drawTrajectories(options, estimate, object);
  drawModels(options, estimate, object);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Draws contact_sheet.png, trajectories.png and models.png of a result folder.\n"
      "Exit codes: 0 done, 1 unusable data, 2 bad command line."};
  app.add_option("--sequence", options.sequence, "input folder in TUM layout (colour, truth)");
  app.add_option("--result", options.result, "folder that rf-run or rf-launch wrote")->required();
  app.add_option("--output", options.output, "where the pictures go (default: the result folder)");
  app.add_option("--camera-prior", options.camera_prior, "trajectory drawn as prior, or none");
  app.add_option("--object-prior", options.object_prior, "trajectory drawn as prior, or none");
  app.add_option("--title", options.title, "shown in the pictures (default: the folder's name)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return run(options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "rf-render: {}\n", e.what());
    return 1;
  }
}
