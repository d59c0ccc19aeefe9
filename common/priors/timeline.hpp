// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace rf {

inline double secondsBetween(std::int64_t from, std::int64_t to) {
  return 1e-6 * static_cast<double>(to - from);
}

/// Stamps beyond +-2^60 microseconds (36,000 years) are no times.
inline constexpr std::int64_t kAbsurdTime = std::int64_t{1} << 60;

/// A stamp with an offset, which an absurd one does not get (it would overflow).
inline std::int64_t shiftedTime(std::int64_t utime, std::int64_t offset_us) {
  return utime > kAbsurdTime || utime < -kAbsurdTime ? utime : utime + offset_us;
}

/// Judges the time stamps of one source. Samples whose time does not advance are refused; when
/// several in a row lie far before the newest and advance among themselves, the source's clock went
/// back (or one stamp lay absurdly ahead) and it begins anew.
class Timeline {
 public:
  enum class Verdict {
    kLater,
    kNotLater,   ///< refuse
    kRestarted,  ///< accept, and forget what came before
    kAbsurd,     ///< refuse: beyond kAbsurdTime
  };
  /// This many refused samples in a row, each later than the one before and further than
  /// kRestartSeconds before the newest, begin the timeline anew.
  static constexpr int kRestartSamples = 5;
  static constexpr double kRestartSeconds = 1.0;

  Verdict judge(std::int64_t utime);
  /// Samples refused since the last one that was taken.
  int refusedInARow() const { return refused_in_a_row_; }

 private:
  std::optional<std::int64_t> newest_;
  std::int64_t newest_refused_ = 0;
  int run_ = 0;
  int refused_in_a_row_ = 0;
};

/// Spans of time in which a source did something that no body can do.
class Breaks {
 public:
  void add(std::int64_t from, std::int64_t to, std::string why);
  void clear() { breaks_.clear(); }
  /// Why the motion from a to b (a <= b) must not be used; empty where no break lies between. Times
  /// before `oldest` or after `newest` sample are extrapolated, so breaks at those samples count.
  std::string within(std::int64_t a, std::int64_t b, std::int64_t oldest,
                     std::int64_t newest) const;

 private:
  struct Break {
    std::int64_t from;
    std::int64_t to;
    std::string why;
  };
  static constexpr std::size_t kMost = 10000;
  std::deque<Break> breaks_;
};

/// What became of a source's samples.
struct SourceCounts {
  std::int64_t accepted = 0;
  std::int64_t refused = 0;   ///< not finite, not a pose, not later, ...
  std::int64_t jumps = 0;     ///< accepted, but too far from the one before
  std::int64_t restarts = 0;  ///< of the source's clock
};

}  // namespace rf
