// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/clusters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/parallel.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

constexpr int kClusterRows = 20;  // fixed: never by thread count

/// Centres as a struct of arrays, for the vectoriser, with their numbers.
struct CentreArrays {
  std::vector<float> x, y, z;
  std::vector<std::int32_t> id;

  CentreArrays() = default;
  explicit CentreArrays(const std::vector<Eigen::Vector3f>& centres) {
    for (const Eigen::Vector3f& c : centres) {
      add(c.x(), c.y(), c.z(), static_cast<std::int32_t>(id.size()));
    }
  }
  void add(float cx, float cy, float cz, std::int32_t k) {
    x.push_back(cx);
    y.push_back(cy);
    z.push_back(cz);
    id.push_back(k);
  }
};

/// Rays of one level's pixels: x/z per column, y/z per row.
class Rays {
 public:
  explicit Rays(const RgbdLevel& level) : level_(level), x_(level.camera.width) {
    for (int u = 0; u < level.camera.width; ++u) {
      x_[u] = (static_cast<float>(u) - static_cast<float>(level.camera.cx)) /
              static_cast<float>(level.camera.fx);
    }
  }
  const float* x() const { return x_.data(); }
  float y(int v) const {
    return (static_cast<float>(v) - static_cast<float>(level_.camera.cy)) /
           static_cast<float>(level_.camera.fy);
  }
  Eigen::Vector3f point(int u, int v) const {
    const float z = level_.depth(u, v);
    return {x_[u] * z, y(v) * z, z};
  }

 private:
  const RgbdLevel& level_;
  std::vector<float> x_;
};

/// The box around some points.
struct Box {
  Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::max());
  Eigen::Array3f high = Eigen::Array3f::Constant(std::numeric_limits<float>::lowest());
  void add(const Eigen::Vector3f& p) {
    low = low.min(p.array());
    high = high.max(p.array());
  }
};

/// The centres that can be the nearest of a point in the box, in their order: those not farther
/// from its nearest point than the best one is from its farthest.
CentreArrays centresNear(const Box& box, const CentreArrays& centres) {
  constexpr float kRounding = 1.0001F;  // of squared distances
  const std::size_t count = centres.x.size();
  std::vector<float> near(count);
  float reach = std::numeric_limits<float>::max();
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Array3f c(centres.x[k], centres.y[k], centres.z[k]);
    near[k] = (box.low - c).max(c - box.high).max(0.0F).square().sum();
    reach = std::min(reach, (c - box.low).max(box.high - c).square().sum());
  }
  CentreArrays out;
  for (std::size_t k = 0; k < count; ++k) {
    if (near[k] <= kRounding * reach) {
      out.add(centres.x[k], centres.y[k], centres.z[k], centres.id[k]);
    }
  }
  return out;
}

/// Finds the nearest centre of the pixels of some rows. A tile of them has only few centres that
/// can be.
class Band {
 public:
  Band(const RgbdLevel& level, const Rays& rays, const CentreArrays& centres, int begin, int end)
      : level_(level), rays_(rays) {
    for (int left = 0; left < level.depth.width(); left += kTile) {
      Box box;
      for (int v = begin; v < end; ++v) {
        for (int u = left; u < std::min(level.depth.width(), left + kTile); ++u) {
          if (level.depth(u, v) > 0) box.add(rays.point(u, v));
        }
      }
      tiles_.push_back(centresNear(box, centres));
    }
  }

  /// Calls use(u, nearest centre, point) for the pixels of row v that have depth; the first of
  /// equally near centres.
  template <typename Use>
  void row(int v, const Use& use) {
    const float ray_y = rays_.y(v);
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
      const int begin = static_cast<int>(tile) * kTile;
      const int n = std::min(kTile, level_.depth.width() - begin);
      const float* z = level_.depth.row(v) + begin;
      const float* ray = rays_.x() + begin;
#pragma GCC ivdep
      for (int i = 0; i < n; ++i) {
        x_[i] = ray[i] * z[i];
        y_[i] = ray_y * z[i];
        best_[i] = std::numeric_limits<float>::max();
        index_[i] = 0;
      }
      nearest(z, n, tiles_[tile]);
      for (int i = 0; i < n; ++i) {
        if (z[i] > 0) {
          use(begin + i, static_cast<std::uint8_t>(index_[i]), Eigen::Vector3f(x_[i], y_[i], z[i]));
        }
      }
    }
  }

 private:
  static constexpr int kTile = 32;

  void nearest(const float* z, int n, const CentreArrays& centres) {
    for (std::size_t k = 0; k < centres.x.size(); ++k) {
      const float cx = centres.x[k], cy = centres.y[k], cz = centres.z[k];
      const std::int32_t id = centres.id[k];
#pragma GCC ivdep
      for (int i = 0; i < n; ++i) {
        const float dx = cx - x_[i], dy = cy - y_[i], dz = cz - z[i];
        const float d = dx * dx + dy * dy + dz * dz;
        const bool nearer = d < best_[i];
        best_[i] = nearer ? d : best_[i];
        index_[i] = nearer ? id : index_[i];
      }
    }
  }

  const RgbdLevel& level_;
  const Rays& rays_;
  std::vector<CentreArrays> tiles_;
  float x_[kTile], y_[kTile], best_[kTile];
  std::int32_t index_[kTile];
};

/// Grid seeds, each at the median depth of the pixels nearest to it in the image plane.
std::vector<Eigen::Vector3f> seeds(const RgbdLevel& level, int count) {
  const int width = level.depth.width();
  const int height = level.depth.height();
  std::vector<std::pair<int, int>> at;
  for (int i = 0; i < count; ++i) {
    const int rows = static_cast<int>(std::ceil(std::sqrt(count)));
    at.emplace_back(static_cast<int>(std::lround((i + 1.0) * width / (count + 1.0))),
                    static_cast<int>(std::lround((i % rows + 1.0) * height / (rows + 1.0))));
  }
  std::vector<std::vector<float>> depths(at.size());
  for (int v = 0; v < height; v += 2) {
    for (int u = 0; u < width; u += 2) {
      const float z = level.depth(u, v);
      if (!(z > 0)) continue;
      int best = std::numeric_limits<int>::max();
      std::size_t index = 0;
      for (std::size_t k = 0; k < at.size(); ++k) {
        const int du = at[k].first - u;
        const int dv = at[k].second - v;
        if (du * du + dv * dv < best) {
          best = du * du + dv * dv;
          index = k;
        }
      }
      depths[index].push_back(z);
    }
  }
  std::vector<Eigen::Vector3f> centres;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (depths[k].empty()) continue;
    auto middle = depths[k].begin() + static_cast<std::ptrdiff_t>(depths[k].size() / 2);
    std::nth_element(depths[k].begin(), middle, depths[k].end());
    const float z = *middle;
    const Camera& c = level.camera;
    centres.emplace_back(static_cast<float>((at[k].first - c.cx) / c.fx) * z,
                         static_cast<float>((at[k].second - c.cy) / c.fy) * z, z);
  }
  return centres;
}

struct CentreSums {
  std::vector<Eigen::Vector3d> sum;
  std::vector<int> count;
  CentreSums& operator+=(const CentreSums& o) {
    for (std::size_t k = 0; k < sum.size(); ++k) {
      sum[k] += o.sum[k];
      count[k] += o.count[k];
    }
    return *this;
  }
};

CentreSums assign(const RgbdLevel& level, const std::vector<Eigen::Vector3f>& centres) {
  const CentreSums zero{std::vector<Eigen::Vector3d>(centres.size(), Eigen::Vector3d::Zero()),
                        std::vector<int>(centres.size(), 0)};
  const CentreArrays arrays(centres);
  const Rays rays(level);
  const int chunks = (level.depth.height() + kClusterRows - 1) / kClusterRows;
  return reduceChunks(chunks, zero, [&](int chunk, CentreSums& out) {
    const int begin = chunk * kClusterRows;
    const int end = std::min(level.depth.height(), begin + kClusterRows);
    Band band(level, rays, arrays, begin, end);
    for (int v = begin; v < end; ++v) {
      band.row(v, [&](int /*u*/, std::uint8_t k, const Eigen::Vector3f& p) {
        out.sum[k] += p.cast<double>();
        ++out.count[k];
      });
    }
  });
}

Image<std::uint8_t> labels(const RgbdLevel& level, const std::vector<Eigen::Vector3f>& centres) {
  Image<std::uint8_t> out(level.depth.width(), level.depth.height(), kNoCluster);
  if (centres.empty()) return out;
  const CentreArrays arrays(centres);
  const Rays rays(level);
  const int chunks = (level.depth.height() + kClusterRows - 1) / kClusterRows;
  parallelChunks(chunks, [&](int chunk) {
    const int begin = chunk * kClusterRows;
    const int end = std::min(level.depth.height(), begin + kClusterRows);
    Band band(level, rays, arrays, begin, end);
    for (int v = begin; v < end; ++v) {
      band.row(v, [&](int u, std::uint8_t k, const Eigen::Vector3f&) { out(u, v) = k; });
    }
  });
  return out;
}

Adjacency adjacencyOf(const RgbdLevel& level, const Image<std::uint8_t>& label, std::size_t count,
                      double contact_m) {
  Adjacency out(count);
  const Rays rays(level);
  const auto limit = static_cast<float>(std::pow(contact_m * 240.0 / level.depth.height(), 2));
  for (int v = 0; v < level.depth.height(); ++v) {
    for (int u = 0; u < level.depth.width(); ++u) {
      const std::uint8_t k = label(u, v);
      if (k == kNoCluster) continue;
      const auto join = [&](int u2, int v2) {
        const std::uint8_t other = label(u2, v2);
        if (other == kNoCluster || other == k) return;
        const Eigen::Vector3f d = rays.point(u, v) - rays.point(u2, v2);
        const float lateral = u2 != u ? d.x() : d.y();
        if (d.z() * d.z() + lateral * lateral < limit) out.join(k, other);
      };
      if (u + 1 < level.depth.width()) join(u + 1, v);
      if (v + 1 < level.depth.height()) join(u, v + 1);
    }
  }
  return out;
}

}  // namespace

Clusters clusterFrame(const std::vector<RgbdLevel>& pyramid, const ClusterParams& params) {
  Clusters out;
  if (pyramid.empty()) return out;
  const RgbdLevel& level = pyramid[pyramid.size() > 1 ? 1 : 0];
  out.centres = seeds(level, params.count);
  for (int iteration = 0; iteration < params.iterations && !out.centres.empty(); ++iteration) {
    const CentreSums sums = assign(level, out.centres);
    std::vector<Eigen::Vector3f> moved;
    out.sizes.clear();
    float change = 0;
    for (std::size_t k = 0; k < out.centres.size(); ++k) {
      if (sums.count[k] == 0) {
        change = std::numeric_limits<float>::max();
        continue;
      }
      moved.push_back((sums.sum[k] / sums.count[k]).cast<float>());
      out.sizes.push_back(sums.count[k]);
      change = std::max(change, (moved.back() - out.centres[k]).cwiseAbs().maxCoeff());
    }
    out.centres = std::move(moved);
    if (change < static_cast<float>(params.tolerance_m)) break;
  }
  for (const RgbdLevel& l : pyramid) out.label.push_back(labels(l, out.centres));
  out.adjacency = adjacencyOf(pyramid[0], out.label[0], out.centres.size(), params.contact_m);
  return out;
}

}  // namespace rf
