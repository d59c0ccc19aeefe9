// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rigidfusion/transform_t.hpp>
#include <string>
#include <vector>

#include "geometry/se3.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

// Parts that several messages share. Copies only: nothing is normalised or rounded.

inline rigidfusion::transform_t toWire(const SE3& T) {
  rigidfusion::transform_t out;
  for (int i = 0; i < 3; ++i) out.trans[i] = T.t[i];
  out.quat_wxyz[0] = T.q.w();
  out.quat_wxyz[1] = T.q.x();
  out.quat_wxyz[2] = T.q.y();
  out.quat_wxyz[3] = T.q.z();
  return out;
}

inline SE3 fromWire(const rigidfusion::transform_t& in) {
  SE3 T;
  T.q = Eigen::Quaterniond(in.quat_wxyz[0], in.quat_wxyz[1], in.quat_wxyz[2], in.quat_wxyz[3]);
  T.t = Vec3(in.trans[0], in.trans[1], in.trans[2]);
  return T;
}

inline void toWire(const Mat6& in, double (&out)[6][6]) {
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) out[r][c] = in(r, c);
  }
}

inline Mat6 fromWire(const double (&in)[6][6]) {
  Mat6 out;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) out(r, c) = in[r][c];
  }
  return out;
}

template <class Message>
void stagesToWire(const StageTimes& times, Message& out) {
  out.n_stages = static_cast<std::int16_t>(times.size());
  for (const auto& [name, ms] : times) {
    out.stage_name.push_back(name);
    out.stage_ms.push_back(ms);
  }
}

template <class Message>
StageTimes stagesFromWire(const Message& in) {
  StageTimes times;
  for (std::size_t i = 0; i < in.stage_name.size(); ++i)
    times.emplace_back(in.stage_name[i], in.stage_ms[i]);
  return times;
}

}  // namespace rf
