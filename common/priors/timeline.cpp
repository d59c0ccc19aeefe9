// SPDX-License-Identifier: BSD-3-Clause
#include "priors/timeline.hpp"

#include <utility>

namespace rf {

Timeline::Verdict Timeline::judge(std::int64_t utime) {
  if (utime > kAbsurdTime || utime < -kAbsurdTime) {
    ++refused_in_a_row_;
    return Verdict::kAbsurd;
  }
  if (!newest_ || utime > *newest_) {
    newest_ = utime;
    run_ = 0;
    refused_in_a_row_ = 0;
    return Verdict::kLater;
  }
  const bool far_back = secondsBetween(utime, *newest_) > kRestartSeconds;
  if (!far_back) {
    run_ = 0;
  } else if (run_ > 0 && utime > newest_refused_) {
    ++run_;
  } else {
    run_ = 1;
  }
  newest_refused_ = utime;
  if (run_ < kRestartSamples) {
    ++refused_in_a_row_;
    return Verdict::kNotLater;
  }
  newest_ = utime;
  run_ = 0;
  refused_in_a_row_ = 0;
  return Verdict::kRestarted;
}

void Breaks::add(std::int64_t from, std::int64_t to, std::string why) {
  if (breaks_.size() == kMost) breaks_.pop_front();
  breaks_.push_back({from, to, std::move(why)});
}

std::string Breaks::within(std::int64_t a, std::int64_t b, std::int64_t oldest,
                           std::int64_t newest) const {
  for (auto at = breaks_.rbegin(); at != breaks_.rend(); ++at) {
    const bool overlaps = at->from < b && at->to > a;
    const bool inside = a == b && at->from < a && a < at->to;
    const bool carried_on = (b > newest && at->to == newest) || (a < oldest && at->from == oldest);
    if (overlaps || inside || carried_on) return at->why;
    if (at->to < a && at->to < newest) break;  // older ones end earlier still
  }
  return {};
}

}  // namespace rf
