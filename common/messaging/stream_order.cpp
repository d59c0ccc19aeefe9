// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/stream_order.hpp"

#include <algorithm>
#include <vector>

#include "priors/compose.hpp"

namespace rf {
namespace {

BodyMotion composeMotions(const BodyMotion& first, const BodyMotion& second) {
  BodyMotion out = second;
  out.T_AB = first.T_AB * second.T_AB;
  const Mat6 back = second.T_AB.inverse().adjoint();
  out.covariance = back * first.covariance * back.transpose() + second.covariance;
  out.health = std::max(first.health, second.health);  // larger is worse
  return out;
}

}  // namespace

FrameKind StreamOrder::judge(std::int64_t utime, std::int64_t seq) const {
  if (recent_.empty() || utime > recent_.back()) return FrameKind::kNew;
  if (utime == recent_.back()) return FrameKind::kRepeated;
  if (seq == 0) return FrameKind::kRestart;
  return std::binary_search(recent_.begin(), recent_.end(), utime) ? FrameKind::kOld
                                                                   : FrameKind::kRestart;
}

std::int64_t StreamOrder::accept(std::int64_t utime, std::int64_t seq) {
  recent_.push_back(utime);
  if (recent_.size() > kMemory) recent_.pop_front();
  const std::int64_t gap = seq >= 0 && last_seq_ >= 0 ? seq - last_seq_ - 1 : 0;
  if (seq >= 0) last_seq_ = seq;
  return std::max<std::int64_t>(gap, 0);
}

void StreamOrder::reset() {
  recent_.clear();
  last_seq_ = -1;
}

std::optional<std::int64_t> StreamOrder::lastUtime() const {
  if (recent_.empty()) return std::nullopt;
  return recent_.back();
}

void PriorChain::add(const MotionPrior& prior) {
  if (prior.utime_a == prior.utime_b)
    by_end_.clear();  // a stream begins: older links are of another
  by_end_[prior.utime_b] = prior;
  while (by_end_.size() > kMemory) by_end_.erase(by_end_.begin());
}

std::optional<MotionPrior> PriorChain::find(std::int64_t utime_a, std::int64_t utime_b) const {
  std::vector<const MotionPrior*> links;  // newest first
  for (std::int64_t end = utime_b; links.empty() || end > utime_a;) {
    const auto it = by_end_.find(end);
    if (it == by_end_.end() || it->second.utime_a < utime_a) return std::nullopt;
    links.push_back(&it->second);
    if (it->second.utime_a == end) break;  // a stream's first frame
    end = it->second.utime_a;
  }
  if (links.back()->utime_a != utime_a) return std::nullopt;
  MotionPrior out = *links.back();
  for (std::size_t i = links.size() - 1; i-- > 0;) out = composePriors(out, *links[i]);
  return out;
}

std::optional<MotionPrior> PriorChain::endingAt(std::int64_t utime_b) const {
  const auto it = by_end_.find(utime_b);
  if (it == by_end_.end()) return std::nullopt;
  return it->second;
}

void PriorChain::forgetBefore(std::int64_t utime) {
  by_end_.erase(by_end_.begin(), by_end_.lower_bound(utime));
}

MotionPrior missingPrior(std::int64_t utime_a, std::int64_t utime_b, std::int64_t seq) {
  MotionPrior prior;
  prior.utime_a = utime_a;
  prior.utime_b = utime_b;
  prior.seq = seq;
  return prior;
}

MotionPrior firstFramePrior(const MotionPrior& link) {
  MotionPrior out = link;
  out.utime_a = link.utime_b;
  out.T_CaCb = SE3();
  out.T_XOa = link.T_XOb;
  return out;
}

SegmentationResult composeSegmentations(const SegmentationResult& skipped,
                                        const SegmentationResult& next) {
  SegmentationResult out = next;
  out.utime_a = skipped.utime_a;
  out.first = skipped.first;
  if (!skipped.first) {
    out.camera = composeMotions(skipped.camera, next.camera);
    out.object = composeMotions(skipped.object, next.object);
  }
  return out;
}

}  // namespace rf
