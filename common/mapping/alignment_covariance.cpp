// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/alignment_covariance.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Cholesky>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

// 40 x 40 pixels of a 320 x 240 image: wider than what makes neighbouring residuals alike (depth
// noise, discs, one face of a thing), and still enough blocks to average.
constexpr int kColumns = 8;
constexpr int kRows = 6;
constexpr std::size_t kBlocks = std::size_t{kColumns} * kRows;

std::size_t blockOf(const ReferencePoints& p, std::size_t i, const Camera& c) {
  const double u = c.fx * static_cast<double>(p.x[i] / p.z[i]) + c.cx;
  const double v = c.fy * static_cast<double>(p.y[i] / p.z[i]) + c.cy;
  const int column = std::clamp(static_cast<int>(u * kColumns / c.width), 0, kColumns - 1);
  const int row = std::clamp(static_cast<int>(v * kRows / c.height), 0, kRows - 1);
  return static_cast<std::size_t>(row * kColumns + column);
}

void copyPoint(const ReferencePoints& from, std::size_t i, ReferencePoints& to) {
  to.x.push_back(from.x[i]);
  to.y.push_back(from.y[i]);
  to.z.push_back(from.z[i]);
  to.nx.push_back(from.nx[i]);
  to.ny.push_back(from.ny[i]);
  to.nz.push_back(from.nz[i]);
  to.intensity.push_back(from.intensity[i]);
  to.weight.push_back(from.weight[i]);
}

double meanOf(const std::vector<float>& values) {
  double sum = 0;
  for (const float x : values) sum += static_cast<double>(x);
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

// What a block may be displaced by without a residual, as the pose that displaces it so.
Mat6 ownDisplacement(double depth, const AlignmentNoise& noise, double sigma) {
  const double across = noise.factor * noise.assumed * CommonError::kPhase * depth / noise.focal_px;
  const double along = CommonError::kDepthShare * sigma;
  Mat6 C = Mat6::Zero();
  C.diagonal().head<3>() << across * across, across * across, along * along;
  return C;
}

// The fit itself took six degrees of freedom from the gradients.
double freedomFactor(std::size_t blocks) {
  const auto n = static_cast<double>(blocks);
  return n / std::max(1.0, n - 6.0);
}

}  // namespace

Mat6 hessianOf(const KernelSums& sums) {
  Mat6 H;
  std::size_t at = 0;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) H(r, c) = H(c, r) = sums.H[at++];
  }
  return H;
}

std::vector<AlignmentBlock> alignmentBlocks(const ReferencePoints& points, const Camera& camera,
                                            const KernelInput& input) {
  std::vector<ReferencePoints> split(kBlocks);
  for (std::size_t i = 0; i < points.size(); ++i) {
    copyPoint(points, i, split[blockOf(points, i, camera)]);
  }
  std::vector<AlignmentBlock> blocks(kBlocks);
  parallelChunks(static_cast<int>(kBlocks), [&](int b) {
    const auto k = static_cast<std::size_t>(b);
    accumulateRows(split[k], 0, split[k].size(), input, blocks[k].sums);
    blocks[k].depth = meanOf(split[k].z);
  });
  std::erase_if(blocks, [](const AlignmentBlock& b) { return !(b.sums.pairs > 0); });
  return blocks;
}

Mat6 alignmentCovariance(const std::vector<AlignmentBlock>& blocks, const AlignmentNoise& noise) {
  Mat6 information = Mat6::Zero();
  Mat6 left = Mat6::Zero();
  Mat6 hidden = Mat6::Zero();
  Vec6 nearer = Vec6::Zero();
  for (const AlignmentBlock& b : blocks) {
    const Mat6 H = hessianOf(b.sums) / noise.correlation;
    const Vec6 gradient = Eigen::Map<const Vec6>(b.sums.b.data()) / noise.correlation;
    const double sigma =
        noise.factor * static_cast<double>(noise.sensor.sigma(static_cast<float>(b.depth)));
    information += H;
    left += gradient * gradient.transpose();
    hidden += H * ownDisplacement(b.depth, noise, sigma) * H;
    nearer += CommonError::kNearerShare * sigma * H.col(2);
  }
  const Mat6 white = noise.factor * noise.factor * information + noise.prior;
  const Mat6 spread =
      white + freedomFactor(blocks.size()) * left + hidden + nearer * nearer.transpose();
  const Eigen::LDLT<Mat6> factor(information + noise.prior);
  const Mat6 half = factor.solve(spread);
  const Mat6 covariance = factor.solve(half.transpose());
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace rf
