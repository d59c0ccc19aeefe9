// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/pyramid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

constexpr int kChunkRows = 16;  // output rows; fixed, so that thread counts do not change bits
constexpr int kSmallestSide = 8;
constexpr double kBlockShare = 0.25;  // measured pixels a block of a non-power-of-two factor needs

template <typename Body>
void forChunks(int height, const Body& body) {
  const int chunks = (height + kChunkRows - 1) / kChunkRows;
  parallelChunks(chunks, [&](int chunk) {
    body(chunk * kChunkRows, std::min(height, (chunk + 1) * kChunkRows));
  });
}

/// Raw pixels to luma and metres.
class RawSource {
 public:
  RawSource(const Image<Rgb>& colour, const Image<std::uint16_t>& depth_mm, double min_m,
            double max_m)
      : colour_(colour), depth_(depth_mm) {
    // Whole millimetres inside [min, max]; the comparison is exact and cheap.
    low_ = static_cast<int>(std::ceil(std::clamp(min_m, 0.001, 66.0) * 1000.0 - 1e-6));
    high_ = static_cast<int>(std::floor(std::clamp(max_m, 0.0, 66.0) * 1000.0 + 1e-6));
  }
  int width() const { return depth_.width(); }
  int height() const { return depth_.height(); }
  float intensity(int u, int v) const { return luma(colour_(u, v)); }
  float depth(int u, int v) const { return metres(depth_(u, v)); }

  /// Splits a row into even and odd columns (n of each), so that the kernels run at unit stride.
  void split(int v, int n, float* ie, float* io, float* de, float* od) const {
    const Rgb* c = colour_.row(v);
    const std::uint16_t* d = depth_.row(v);
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) {
      ie[i] = luma(c[2 * i]);
      io[i] = luma(c[2 * i + 1]);
    }
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) {
      de[i] = metres(d[2 * i]);
      od[i] = metres(d[2 * i + 1]);
    }
  }

 private:
  static float luma(const Rgb& c) {
    return static_cast<float>(299 * c.r + 587 * c.g + 114 * c.b) * (1.0F / 255000.0F);
  }
  float metres(std::uint16_t mm) const {
    const int z = mm;
    return ((z >= low_) & (z <= high_)) ? static_cast<float>(z) * 0.001F : 0.0F;
  }

  const Image<Rgb>& colour_;
  const Image<std::uint16_t>& depth_;
  int low_ = 0;
  int high_ = 0;
};

class LevelSource {
 public:
  explicit LevelSource(const RgbdLevel& level) : level_(level) {}
  int width() const { return level_.depth.width(); }
  int height() const { return level_.depth.height(); }
  float intensity(int u, int v) const { return level_.intensity(u, v); }
  float depth(int u, int v) const { return level_.depth(u, v); }
  void split(int v, int n, float* ie, float* io, float* de, float* od) const {
    const float* c = level_.intensity.row(v);
    const float* d = level_.depth.row(v);
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) {
      ie[i] = c[2 * i];
      io[i] = c[2 * i + 1];
      de[i] = d[2 * i];
      od[i] = d[2 * i + 1];
    }
  }

 private:
  const RgbdLevel& level_;
};

struct SplitRow {
  std::vector<float> ie, io, de, od;
  explicit SplitRow(int n) : ie(n), io(n), de(n), od(n) {}
};

struct RowSums {
  std::vector<float> centre, plain, weight, depth, intensity;
  explicit RowSums(int n) : centre(n), plain(n), weight(n), depth(n), intensity(n) {}
};

float secondLargest(float a, float b, float c, float d) {
  const float max1 = a > b ? a : b;
  const float min1 = a > b ? b : a;
  const float max2 = c > d ? c : d;
  const float min2 = c > d ? d : c;
  const float low_max = max1 > max2 ? max2 : max1;
  const float high_min = min1 > min2 ? min1 : min2;
  return low_max > high_min ? low_max : high_min;
}

void centreDepths(const SplitRow& top, const SplitRow& low, int n, float* out) {
  const float *a = top.de.data(), *b = top.od.data(), *c = low.de.data(), *d = low.od.data();
  for (int u = 0; u < n; ++u) out[u] = secondLargest(a[u], b[u], c[u], d[u]);
}

/// Adds one of the four rows of the 4x4 block with row weight m (1 or 2, over 36).
void addRow(const SplitRow& row, float m, float gate, int n, RowSums& sums) {
  const float *ie = row.ie.data(), *io = row.io.data(), *de = row.de.data(), *od = row.od.data();
  const float* __restrict centre = sums.centre.data();
  float* __restrict plain = sums.plain.data();
  float* __restrict weight = sums.weight.data();
  float* __restrict depth = sums.depth.data();
  float* __restrict intensity = sums.intensity.data();
  const auto gated = [gate](float d, float c) {
    const float t = gate - std::abs(d - c);
    return ((t > 0.0F) & (d > 0.0F)) ? t : 0.0F;
  };
#pragma GCC ivdep
  for (int u = 1; u < n; ++u) {
    const float c = centre[u];
    const float d0 = od[u - 1], d1 = de[u], d2 = od[u], d3 = de[u + 1];
    const float i0 = io[u - 1], i1 = ie[u], i2 = io[u], i3 = ie[u + 1];
    const float w0 = m * gated(d0, c), w1 = 2.0F * m * gated(d1, c);
    const float w2 = 2.0F * m * gated(d2, c), w3 = m * gated(d3, c);
    plain[u] += m * (i0 + 2.0F * i1 + 2.0F * i2 + i3);
    weight[u] += (w0 + w1) + (w2 + w3);
    depth[u] += (w0 * d0 + w1 * d1) + (w2 * d2 + w3 * d3);
    intensity[u] += (w0 * i0 + w1 * i1) + (w2 * i2 + w3 * i3);
  }
}

void finishRow(const RowSums& sums, int n, float* intensity, float* depth) {
  const float *centre = sums.centre.data(), *weight = sums.weight.data();
  const float *sum_d = sums.depth.data(), *sum_i = sums.intensity.data(),
              *plain = sums.plain.data();
#pragma GCC ivdep
  for (int u = 1; u < n; ++u) {
    const bool valid = (centre[u] > 0.0F) & (weight[u] > 0.0F);
    const float scale = 1.0F / (valid ? weight[u] : 1.0F);
    depth[u] = valid ? sum_d[u] * scale : 0.0F;
    intensity[u] = valid ? sum_i[u] * scale : plain[u];
  }
}

template <typename Source>
void borderPixel(const Source& in, int u, int v, RgbdLevel& out) {
  float intensity = 0, depth = 0;
  int count = 0;
  for (int dv = 0; dv < 2; ++dv) {
    for (int du = 0; du < 2; ++du) {
      const float d = in.depth(2 * u + du, 2 * v + dv);
      intensity += in.intensity(2 * u + du, 2 * v + dv);
      depth += d;
      count += d > 0 ? 1 : 0;
    }
  }
  out.intensity(u, v) = 0.25F * intensity;
  out.depth(u, v) = count > 0 ? depth / static_cast<float>(count) : 0.0F;
}

template <typename Source>
RgbdLevel halve(const Source& in, const Camera& camera, float gate) {
  RgbdLevel out;
  out.camera = camera.reduced(2);
  const int width = out.camera.width, height = out.camera.height;
  out.intensity = Image<float>(width, height);
  out.depth = Image<float>(width, height);
  // Inner pixels have a whole 4x4 block inside the finer image.
  const int end_u = (in.width() - 3) / 2 + 1, end_v = (in.height() - 3) / 2 + 1;
  const int columns = in.width() / 2;
  forChunks(height, [&](int begin, int end) {
    std::array<SplitRow, 4> rows = {SplitRow(columns), SplitRow(columns), SplitRow(columns),
                                    SplitRow(columns)};
    // An odd width leaves its last column out of the split; the last inner pixel never needs it
    // unless it is even column `columns`, so the inner range is cut to what the split holds.
    const int inner_end = std::min(end_u, columns - 1);
    RowSums sums(columns);
    int loaded = -1;  // highest source row in the ring
    for (int v = begin; v < end; ++v) {
      const bool inner = v > 0 && v < end_v;
      if (inner) {
        for (int r = std::max(loaded + 1, 2 * v - 1); r <= 2 * v + 2; ++r) {
          SplitRow& s = rows[static_cast<std::size_t>(r % 4)];
          in.split(r, columns, s.ie.data(), s.io.data(), s.de.data(), s.od.data());
          loaded = r;
        }
        const auto row = [&](int r) -> const SplitRow& {
          return rows[static_cast<std::size_t>(r % 4)];
        };
        centreDepths(row(2 * v), row(2 * v + 1), columns, sums.centre.data());
        for (auto* plane : {&sums.plain, &sums.weight, &sums.depth, &sums.intensity}) {
          std::fill(plane->begin(), plane->end(), 0.0F);
        }
        for (int k = 0; k < 4; ++k) {
          addRow(row(2 * v - 1 + k), (k == 1 || k == 2 ? 2.0F : 1.0F) / 36.0F, gate, inner_end,
                 sums);
        }
        finishRow(sums, inner_end, out.intensity.row(v), out.depth.row(v));
      }
      for (int u = 0; u < width; ++u) {
        if (!inner || u < 1 || u >= inner_end) borderPixel(in, u, v, out);
      }
    }
  });
  return out;
}

template <typename Source>
RgbdLevel convert(const Source& in, const Camera& camera) {
  RgbdLevel out{camera, Image<float>(camera.width, camera.height),
                Image<float>(camera.width, camera.height)};
  forChunks(camera.height, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        out.intensity(u, v) = in.intensity(u, v);
        out.depth(u, v) = in.depth(u, v);
      }
    }
  });
  return out;
}

template <typename Source>
void blockPixel(const Source& in, int f, int u, int v, std::vector<float>& depths, RgbdLevel& out) {
  depths.clear();
  float plain = 0;
  for (int y = v * f; y < v * f + f; ++y) {
    for (int x = u * f; x < u * f + f; ++x) {
      plain += in.intensity(x, y);
      if (const float d = in.depth(x, y); d > 0) depths.push_back(d);
    }
  }
  const float count = static_cast<float>(f) * static_cast<float>(f);
  out.intensity(u, v) = plain / count;
  out.depth(u, v) = 0;
  if (static_cast<double>(depths.size()) < std::max(1.0, kBlockShare * count)) return;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  const float centre = *middle;
  float weight = 0, depth = 0, intensity = 0;
  for (int y = v * f; y < v * f + f; ++y) {
    for (int x = u * f; x < u * f + f; ++x) {
      const float d = in.depth(x, y);
      const float w = d > 0 ? std::max(0.0F, kDefaultDepthGate - std::abs(d - centre)) : 0.0F;
      weight += w;
      depth += w * d;
      intensity += w * in.intensity(x, y);
    }
  }
  out.depth(u, v) = depth / weight;  // the median itself weighs kDefaultDepthGate
  out.intensity(u, v) = intensity / weight;
}

template <typename Source>
RgbdLevel reduceBlocks(const Source& in, const Camera& camera, int f) {
  RgbdLevel out;
  out.camera = camera.reduced(f);
  out.intensity = Image<float>(out.camera.width, out.camera.height);
  out.depth = Image<float>(out.camera.width, out.camera.height);
  forChunks(out.camera.height, [&](int begin, int end) {
    std::vector<float> depths;
    depths.reserve(static_cast<std::size_t>(f) * static_cast<std::size_t>(f));
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < out.camera.width; ++u) blockPixel(in, f, u, v, depths, out);
    }
  });
  return out;
}

void require(bool ok, const std::string& message) {
  if (!ok) throw std::invalid_argument(message);
}

}  // namespace

RgbdLevel reduceFrame(const Image<Rgb>& colour, const Image<std::uint16_t>& depth_mm,
                      const Camera& undistorted_camera, int reduction, double min_depth_m,
                      double max_depth_m) {
  const Camera& camera = undistorted_camera;
  const std::string size = std::to_string(camera.width) + "x" + std::to_string(camera.height);
  require(colour.width() == camera.width && colour.height() == camera.height,
          "reduceFrame: colour image is " + std::to_string(colour.width()) + "x" +
              std::to_string(colour.height()) + ", must be the camera's " + size);
  require(depth_mm.width() == camera.width && depth_mm.height() == camera.height,
          "reduceFrame: depth image is " + std::to_string(depth_mm.width()) + "x" +
              std::to_string(depth_mm.height()) + ", must be the camera's " + size);
  require(!camera.hasDistortion(), "reduceFrame: the camera has lens distortion, undistort first");
  require(reduction >= 1 && camera.width / reduction >= 1 && camera.height / reduction >= 1,
          "reduceFrame: reduction = " + std::to_string(reduction) +
              ": must be 1 or more and leave "
              "at least one pixel of " +
              size);
  const RawSource raw(colour, depth_mm, min_depth_m, max_depth_m);
  if (reduction == 1) return convert(raw, camera);
  if ((reduction & (reduction - 1)) != 0) return reduceBlocks(raw, camera, reduction);
  RgbdLevel level = halve(raw, camera, kDefaultDepthGate);
  for (int f = 2; f < reduction; f *= 2) level = reduceByTwo(level);
  return level;
}

RgbdLevel reduceByTwo(const RgbdLevel& finer, float depth_gate_m) {
  return halve(LevelSource(finer), finer.camera, depth_gate_m);
}

std::vector<RgbdLevel> buildPyramid(RgbdLevel finest, int levels, float depth_gate_m) {
  require(levels >= 1, "buildPyramid: levels = " + std::to_string(levels) + ": must be >= 1");
  std::vector<RgbdLevel> pyramid;
  pyramid.push_back(std::move(finest));
  for (int i = 1; i < levels; ++i) {
    const Camera& last = pyramid.back().camera;
    if (std::min(last.width, last.height) < 2 * kSmallestSide) break;
    pyramid.push_back(reduceByTwo(pyramid.back(), depth_gate_m));
  }
  return pyramid;
}

}  // namespace rf
