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

/// Centres as a struct of arrays, for the vectoriser.
struct CentreArrays {
  std::vector<float> x, y, z;
  explicit CentreArrays(const std::vector<Eigen::Vector3f>& centres) {
    for (const Eigen::Vector3f& c : centres) {
      x.push_back(c.x());
      y.push_back(c.y());
      z.push_back(c.z());
    }
  }
};

/// Rays of one level's pixels (x/z per column, y/z per row) and buffers for one block of a row.
class RowKernel {
 public:
  explicit RowKernel(const RgbdLevel& level) : level_(level), ray_x_(level.camera.width) {
    for (int u = 0; u < level.camera.width; ++u) {
      ray_x_[u] = (static_cast<float>(u) - static_cast<float>(level.camera.cx)) /
                  static_cast<float>(level.camera.fx);
    }
  }
  float rayY(int v) const {
    return (static_cast<float>(v) - static_cast<float>(level_.camera.cy)) /
           static_cast<float>(level_.camera.fy);
  }
  Eigen::Vector3f point(int u, int v) const {
    const float z = level_.depth(u, v);
    return {ray_x_[u] * z, rayY(v) * z, z};
  }

  /// Calls use(u, nearest centre, point) for the pixels of row v that have depth; the first of
  /// equally near centres.
  template <typename Use>
  void row(int v, const CentreArrays& centres, const Use& use) {
    const float ray_y = rayY(v);
    for (int begin = 0; begin < level_.depth.width(); begin += kBlock) {
      const int n = std::min(kBlock, level_.depth.width() - begin);
      const float* z = level_.depth.row(v) + begin;
      const float* ray = ray_x_.data() + begin;
#pragma GCC ivdep
      for (int i = 0; i < n; ++i) {
        x_[i] = ray[i] * z[i];
        y_[i] = ray_y * z[i];
        best_[i] = std::numeric_limits<float>::max();
        index_[i] = 0;
      }
      nearest(z, n, centres);
      for (int i = 0; i < n; ++i) {
        if (z[i] > 0) {
          use(begin + i, static_cast<std::uint8_t>(index_[i]), Eigen::Vector3f(x_[i], y_[i], z[i]));
        }
      }
    }
  }

 private:
  static constexpr int kBlock = 256;

  void nearest(const float* z, int n, const CentreArrays& centres) {
    for (std::size_t k = 0; k < centres.x.size(); ++k) {
      const float cx = centres.x[k], cy = centres.y[k], cz = centres.z[k];
      const auto id = static_cast<std::int32_t>(k);
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
  std::vector<float> ray_x_;
  float x_[kBlock], y_[kBlock], best_[kBlock];
  std::int32_t index_[kBlock];
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
  const int chunks = (level.depth.height() + kClusterRows - 1) / kClusterRows;
  return reduceChunks(chunks, zero, [&](int chunk, CentreSums& out) {
    RowKernel kernel(level);
    const int end = std::min(level.depth.height(), (chunk + 1) * kClusterRows);
    for (int v = chunk * kClusterRows; v < end; ++v) {
      kernel.row(v, arrays, [&](int /*u*/, std::uint8_t k, const Eigen::Vector3f& p) {
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
  const int chunks = (level.depth.height() + kClusterRows - 1) / kClusterRows;
  parallelChunks(chunks, [&](int chunk) {
    RowKernel kernel(level);
    const int end = std::min(level.depth.height(), (chunk + 1) * kClusterRows);
    for (int v = chunk * kClusterRows; v < end; ++v) {
      kernel.row(v, arrays, [&](int u, std::uint8_t k, const Eigen::Vector3f&) { out(u, v) = k; });
    }
  });
  return out;
}

Adjacency adjacencyOf(const RgbdLevel& level, const Image<std::uint8_t>& label, std::size_t count,
                      double contact_m) {
  Adjacency out(count);
  const RowKernel kernel(level);
  const auto limit = static_cast<float>(std::pow(contact_m * 240.0 / level.depth.height(), 2));
  for (int v = 0; v < level.depth.height(); ++v) {
    for (int u = 0; u < level.depth.width(); ++u) {
      const std::uint8_t k = label(u, v);
      if (k == kNoCluster) continue;
      const auto join = [&](int u2, int v2) {
        const std::uint8_t other = label(u2, v2);
        if (other == kNoCluster || other == k) return;
        const Eigen::Vector3f d = kernel.point(u, v) - kernel.point(u2, v2);
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
