// SPDX-License-Identifier: BSD-3-Clause
#include "models.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "canvas.hpp"
#include "plot.hpp"
#include "splat.hpp"

namespace rf::render {
namespace {

constexpr int kHigh = 640;      ///< of the panels
constexpr int kOverview = 820;  ///< widths
constexpr int kPlan = 640;
constexpr int kSide = 400;
constexpr double kTint = 0.35;  ///< red mixed into the object where it stands in the world

Vec3 position(const SurfelPoint& s) { return {s.x, s.y, s.z}; }
Vec3 normal(const SurfelPoint& s) { return {s.nx, s.ny, s.nz}; }

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

Vec3 anyOrthogonal(const Vec3& n) {
  const Vec3 seed = std::abs(n.x()) < 0.8 ? Vec3::UnitX() : Vec3::UnitY();
  return (seed - seed.dot(n) * n).normalized();
}

/// The box that holds the share `kept` of the surfels along three axes.
struct Extent {
  Vec3 low;
  Vec3 high;
};

Extent extentAlong(const std::vector<SurfelPoint>& surfels, const Mat3& axes, double kept) {
  Extent extent{Vec3::Zero(), Vec3::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(surfels.size());
    for (const SurfelPoint& s : surfels) values.push_back(axes.col(axis).dot(position(s)));
    extent.low[axis] = percentile(values, (1 - kept) / 2);
    extent.high[axis] = percentile(values, (1 + kept) / 2);
  }
  return extent;
}

/// Looks along the third axis of R_WV from outside onto all that is in the extent.
View orthographicView(int width, int height, const Mat3& R_WV, const Extent& extent) {
  const Vec3 size = (extent.high - extent.low).cwiseMax(0.05);
  View view{width, height, true, 0, {}};
  view.scale = 0.88 * std::min(width / size.x(), height / size.y());
  const Vec3 centre_V = (extent.low + extent.high) / 2;
  const Vec3 eye_V(centre_V.x(), centre_V.y(), extent.low.z() - 1.0);
  view.T_VW = SE3(R_WV, R_WV * eye_V).inverse();
  return view;
}

Mat3 plannedAxes(const Vec3& sky, const Vec3& right_hint) {
  Vec3 right = right_hint - right_hint.dot(sky) * sky;
  right = right.norm() > 0.2 ? Vec3(right.normalized()) : anyOrthogonal(sky);
  Mat3 R_WV;  // x right, y down in the plan, z down to the floor
  R_WV.col(0) = right;
  R_WV.col(1) = -sky.cross(right);
  R_WV.col(2) = -sky;
  return R_WV;
}

/// What the first camera had before it: surfels within 45 degrees of its axis.
std::vector<SurfelPoint> seenFirst(const ModelScene& scene) {
  const SE3 T_CW = scene.camera.front().pose.inverse();
  std::vector<SurfelPoint> seen;
  for (const SurfelPoint& s : scene.world) {
    const Vec3 p = T_CW * position(s);
    if (p.z() > 0.2 && std::abs(p.x()) < p.z() && std::abs(p.y()) < p.z()) seen.push_back(s);
  }
  return seen.empty() ? scene.world : seen;
}

/// Perspective view from behind and above the first camera that frames what it saw.
View overviewView(const ModelScene& scene, const Vec3& sky) {
  const std::vector<SurfelPoint> seen = seenFirst(scene);
  const Extent middle = extentAlong(seen, Mat3::Identity(), 0);
  const Vec3 eye_C = scene.camera.front().pose.t;
  Vec3 ahead = middle.low - eye_C;
  ahead -= ahead.dot(sky) * sky;
  ahead = ahead.norm() > 0.1 ? Vec3(ahead.normalized()) : anyOrthogonal(sky);
  View view{kOverview, kHigh, false, kOverview, {}};
  view.T_VW = lookAt(eye_C - 1.0 * ahead + 0.9 * sky, middle.low, sky);
  std::vector<double> across;
  std::vector<double> along;
  for (const SurfelPoint& s : seen) {
    const Vec3 p = view.T_VW * position(s);
    if (p.z() < 0.3) continue;
    across.push_back(std::abs(p.x() / p.z()));
    along.push_back(std::abs(p.y() / p.z()));
  }
  const double wide = std::max(0.1, percentile(across, 0.97));
  const double high = std::max(0.1, percentile(along, 0.97));
  view.scale = std::clamp(0.46 * std::min(kOverview / wide, kHigh / high), 0.45 * kOverview,
                          2.5 * kOverview);
  return view;
}

cv::Mat overview(const ModelScene& scene, const Vec3& sky) {
  const View view = overviewView(scene, sky);
  Raster raster = emptyRaster(view);
  splat(scene.world, SE3(), view, 0, raster);
  if (!scene.object_path.empty()) {
    splat(scene.object, scene.object_path.back().pose, view, kTint, raster);
  }
  return raster.colour;
}

/// How often a pixel of the plan is hit by upright surfaces, as a darkness from 0 to 1.
cv::Mat uprightDensity(const std::vector<SurfelPoint>& world, const View& view, const Vec3& sky) {
  cv::Mat count(view.height, view.width, CV_32F, cv::Scalar(0));
  for (const SurfelPoint& s : world) {
    if (std::abs(normal(s).dot(sky)) > 0.5) continue;
    const Vec3 px = toPixel(view, position(s));
    const int u = static_cast<int>(std::lround(px.x()));
    const int v = static_cast<int>(std::lround(px.y()));
    if (u < 0 || v < 0 || u >= view.width || v >= view.height) continue;
    count.at<float>(v, u) += 1;
  }
  std::vector<double> hit;
  for (const float c : cv::Mat_<float>(count)) {
    if (c > 0) hit.push_back(c);
  }
  const double full = std::max(2.0, percentile(hit, 0.9));
  for (float& c : cv::Mat_<float>(count)) c = static_cast<float>(std::min(1.0, c / full));
  return count;
}

std::vector<cv::Point2d> pathPixels(const Trajectory& path, const Vec3& point, const View& view) {
  std::vector<cv::Point2d> pixels;
  for (const StampedPose& p : path) {
    const Vec3 px = toPixel(view, p.pose * point);
    pixels.emplace_back(px.x(), px.y());
  }
  return pixels;
}

/// Mean position; not of an empty model.
Vec3 centroid(const std::vector<SurfelPoint>& surfels) {
  Vec3 sum = Vec3::Zero();
  for (const SurfelPoint& s : surfels) sum += position(s);
  return sum / static_cast<double>(surfels.size());
}

void drawScaleBar(Canvas& canvas, cv::Point2d at, double pixels_per_metre) {
  double metres = 5;
  for (const double shorter : {2.0, 1.0, 0.5, 0.2, 0.1}) {
    if (metres * pixels_per_metre > 160) metres = shorter;
  }
  const double length = metres * pixels_per_metre;
  canvas.rectangle({at.x - 8, at.y - 26, length + 16, 36}, kWhite, true);
  canvas.line(at, {at.x + length, at.y}, kBlack, 2);
  canvas.line({at.x, at.y - 5}, {at.x, at.y + 5}, kBlack, 1.5);
  canvas.line({at.x + length, at.y - 5}, {at.x + length, at.y + 5}, kBlack, 1.5);
  canvas.text({at.x + length / 2, at.y - 9}, fmt::format("{:g} m", metres), 11, kBlack,
              Align::kCentre);
}

void drawPath(Canvas& canvas, const std::vector<cv::Point2d>& pixels, const Colour& colour) {
  if (pixels.empty()) return;
  canvas.polyline(pixels, colour, 2.5);
  canvas.disc(pixels.front(), 5, colour);
  canvas.square(pixels.back(), 4, colour);
}

cv::Mat plan(const ModelScene& scene, const Vec3& sky) {
  const Mat3 axes = plannedAxes(sky, scene.camera.front().pose.q * Vec3::UnitX());
  Extent extent = extentAlong(scene.world, axes, 0.98);
  for (const StampedPose& p : scene.camera) {
    const Vec3 at = axes.transpose() * p.pose.t;
    extent.low = extent.low.cwiseMin(at);
    extent.high = extent.high.cwiseMax(at);
  }
  const View view = orthographicView(kPlan, kHigh, axes, extent);
  Raster raster = emptyRaster(view);
  splat(scene.world, SE3(), view, 0, raster);
  const cv::Mat density = uprightDensity(scene.world, view, sky);
  for (int v = 0; v < view.height; ++v) {
    for (int u = 0; u < view.width; ++u) {
      auto& pixel = raster.colour.at<cv::Vec3b>(v, u);
      const double dark = density.at<float>(v, u);
      for (int i = 0; i < 3; ++i) {
        pixel[i] = cv::saturate_cast<std::uint8_t>((1 - dark) * (0.45 * pixel[i] + 140));
      }
    }
  }
  Canvas canvas(kPlan, kHigh);
  canvas.paste({0, 0}, raster.colour);
  if (!scene.object.empty()) {
    drawPath(canvas, pathPixels(scene.object_path, centroid(scene.object), view), kRed);
  }
  drawPath(canvas, pathPixels(scene.camera, Vec3::Zero(), view), kBlue);
  drawScaleBar(canvas, {20, kHigh - 20.0}, view.scale);
  return canvas.finish();
}

/// The object alone, seen against `gaze` (object frame) with `up` upwards.
cv::Mat objectView(const std::vector<SurfelPoint>& object, const Vec3& gaze, const Vec3& up) {
  const int height = (kHigh - kGap) / 2;
  Mat3 R_OV = lookAt(Vec3::Zero(), gaze, up).R().transpose();
  const View view = orthographicView(kSide, height, R_OV, extentAlong(object, R_OV, 0.99));
  Raster raster = emptyRaster(view);
  splat(object, SE3(), view, 0, raster);
  Canvas canvas(kSide, height);
  canvas.paste({0, 0}, raster.colour);
  drawScaleBar(canvas, {16, height - 14.0}, view.scale);
  return canvas.finish();
}

void drawObject(Canvas& canvas, cv::Point at, const ModelScene& scene, const Vec3& sky) {
  if (scene.object.empty() || scene.object_path.empty()) {
    canvas.text({at.x + kSide / 2.0, at.y + kHigh / 2.0}, "no object model", 14, kGrey,
                Align::kCentre);
    return;
  }
  const SE3& T_WO = scene.object_path.front().pose;
  // The camera that saw it first: the pose nearest in time.
  const auto nearest =
      std::min_element(scene.camera.begin(), scene.camera.end(), [&](const auto& a, const auto& b) {
        const std::int64_t birth = scene.object_path.front().utime;
        return std::abs(a.utime - birth) < std::abs(b.utime - birth);
      });
  const Vec3 up = T_WO.q.conjugate() * sky;
  Vec3 gaze = T_WO.q.conjugate() * (nearest->pose.q * Vec3::UnitZ());
  gaze -= gaze.dot(up) * up;
  gaze = gaze.norm() > 0.1 ? Vec3(gaze.normalized()) : anyOrthogonal(up);
  const Vec3 side = up.cross(gaze);
  canvas.paste(at, objectView(scene.object, gaze - 0.25 * up, up));
  canvas.paste({at.x, at.y + (kHigh + kGap) / 2},
               objectView(scene.object, 0.75 * gaze + 0.75 * side - 0.6 * up, up));
}

}  // namespace

Vec3 skyDirection(const std::vector<SurfelPoint>& world, const Trajectory& camera) {
  Vec3 sky = skyAxis(camera);
  constexpr std::size_t kEnough = 500;
  for (const double degrees : {35.0, 25.0, 15.0, 8.0, 8.0}) {
    const double cosine = std::cos(degrees * std::numbers::pi / 180);
    Vec3 sum = Vec3::Zero();
    std::size_t used = 0;
    for (const SurfelPoint& s : world) {
      if (normal(s).dot(sky) < cosine) continue;
      sum += normal(s);
      ++used;
    }
    if (used < kEnough) break;
    sky = sum.normalized();
  }
  return sky;
}

cv::Mat modelPicture(const ModelScene& scene, const std::string& title) {
  const int x_plan = kGap + kOverview + kGap;
  const int x_object = x_plan + kPlan + kGap;
  Canvas canvas(x_object + kSide + kGap, kHead + kHigh + kGap);
  canvas.text({kGap, 26}, title, 16, kBlack);
  canvas.text({kGap, 54},
              fmt::format("from behind the first camera ({} surfels; object tinted red)",
                          scene.world.size()),
              12, kBlack);
  canvas.text({double(x_plan), 54}, "plan: upright surfaces dark; camera blue, object red", 12,
              kBlack);
  canvas.text({double(x_object), 54}, fmt::format("object model ({} surfels)", scene.object.size()),
              12, kBlack);
  const Vec3 sky = skyDirection(scene.world, scene.camera);
  canvas.paste({kGap, kHead}, overview(scene, sky));
  canvas.paste({x_plan, kHead}, plan(scene, sky));
  drawObject(canvas, {x_object, kHead}, scene, sky);
  canvas.rectangle({double(kGap), double(kHead), double(kOverview), double(kHigh)}, kGrey, false);
  canvas.rectangle({double(x_plan), double(kHead), double(kPlan), double(kHigh)}, kGrey, false);
  canvas.rectangle({double(x_object), double(kHead), double(kSide), double(kHigh)}, kGrey, false);
  return canvas.finish();
}

}  // namespace rf::render
