// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "segmentation/image_terms.hpp"

namespace rf {
namespace {

Camera testCamera() {
  Camera c;
  c.width = 80;
  c.height = 60;
  c.fx = 66;
  c.fy = 67.5;
  c.cx = 40.2;
  c.cy = 28.7;
  return c;
}

/// Planes that are linear in the pixel, so that look-ups and gradients are exact.
TermLevel linearLevel(double i0, double iu, double iv, double d0, double du, double dv) {
  const Camera c = testCamera();
  RgbdLevel level{c, Image<float>(c.width, c.height), Image<float>(c.width, c.height)};
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      level.intensity(u, v) = static_cast<float>(i0 + iu * u + iv * v);
      level.depth(u, v) = static_cast<float>(d0 + du * u + dv * v);
    }
  }
  return makeTermLevel(level);
}

TEST(ImageTerms, RowsEqualCentralDifferences) {
  ImageTermParams params;
  params.occlusion_gate_m = 1.0;
  const TermLevel a = linearLevel(0.2, 0.004, -0.002, 1.6, 0.006, 0.003);
  const TermLevel b = linearLevel(0.22, 0.004, -0.002, 1.62, 0.006, 0.003);
  Vec6 xi;
  xi << 0.012, -0.008, 0.01, 0.006, -0.009, 0.011;
  const SE3 T = SE3::exp(xi);
  BodyTerms terms;
  linearise(a, b, T, params, true, terms);
  const double h = 2e-3;  // single-precision residuals: a small step would only measure rounding
  for (int k = 0; k < 6; ++k) {
    Vec6 d = Vec6::Zero();
    d[k] = h;
    BodyTerms plus;
    BodyTerms minus;
    linearise(a, b, T * SE3::exp(d), params, false, plus);
    linearise(a, b, T * SE3::exp(-d), params, false, minus);
    int checked = 0;
    for (int v = 10; v < 50; v += 7) {
      for (int u = 10; u < 70; u += 9) {
        const std::size_t i = static_cast<std::size_t>(v * 80 + u);
        if (terms.valid[i] == 0 || plus.valid[i] == 0 || minus.valid[i] == 0) continue;
        ++checked;
        const double di = (plus.r_intensity[i] - minus.r_intensity[i]) / (2 * h);
        const double dd = (plus.r_depth[i] - minus.r_depth[i]) / (2 * h);
        EXPECT_NEAR(terms.row_intensity[k][i], di, 0.02 * std::abs(di) + 0.05)
            << "k=" << k << " u=" << u << " v=" << v;
        EXPECT_NEAR(terms.row_depth[k][i], dd, 0.02 * std::abs(dd) + 0.5)
            << "k=" << k << " u=" << u << " v=" << v;
      }
    }
    EXPECT_GT(checked, 30);
  }
}

TEST(ImageTerms, HiddenAndMissingPixelsAreInvalid) {
  const ImageTermParams params;
  const TermLevel b = linearLevel(0.5, 0, 0, 2.0, 0, 0);
  TermLevel a = linearLevel(0.5, 0, 0, 1.0, 0, 0);  // everything of A lies 1 m in front
  BodyTerms terms;
  linearise(a, b, SE3(), params, false, terms);
  for (const unsigned char v : terms.valid) EXPECT_EQ(v, 0);
  a = linearLevel(0.5, 0, 0, 0.0, 0, 0);  // no depth
  linearise(a, b, SE3(), params, false, terms);
  for (const unsigned char v : terms.valid) EXPECT_EQ(v, 0);
}

TEST(ImageTerms, ThreadsGiveTheSameBits) {
  const ImageTermParams params;
  const TermLevel a = linearLevel(0.2, 0.004, -0.002, 1.6, 0.006, 0.003);
  const SE3 T = SE3::exp((Vec6() << 0.01, 0, 0.01, 0, 0.01, 0).finished());
  BodyTerms one;
  BodyTerms two;
  linearise(a, a, T, params, true, one);
  setThreads(2);
  linearise(a, a, T, params, true, two);
  setThreads(1);
  EXPECT_EQ(one.valid, two.valid);
  EXPECT_EQ(one.r_depth, two.r_depth);
  EXPECT_EQ(one.row_intensity[4], two.row_intensity[4]);
}

}  // namespace
}  // namespace rf
