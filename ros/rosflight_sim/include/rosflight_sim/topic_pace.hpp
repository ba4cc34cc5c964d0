// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

namespace rosflight_sim {

/// How long something is overdue, in wall time that this program had: two looks count as kMaxGap apart at most, so a
/// machine that stood still gives nobody up.
class Overdue {
 public:
  using Wall = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kGiveUp{2};

  void none() { sum_ = {}, last_.reset(); }
  /// Whether it has been overdue at looks for `limit` together since none().
  bool give_up(Wall::time_point now, Wall::duration limit = kGiveUp) {
    if (last_) sum_ += std::min<Wall::duration>(now - *last_, kMaxGap);
    last_ = now;
    return sum_ >= limit;
  }

 private:
  static constexpr auto kMaxGap = std::chrono::milliseconds(50);
  Wall::duration sum_{};
  std::optional<Wall::time_point> last_;
};

/// When the next message of a topic is due, learnt from the stamps of those that came.
///
/// The topic counts when kFirst intervals are known. Until then time makes a step when a message has come since the last step, or
/// after kLearning of wall time. Time that ran ahead would teach the interval of a node that cannot keep up, and keep it there: it
/// would be given until then for each answer. Stamps from before the first message came are of such a time, and teach nothing.
class TopicPace {
 public:
  using Wall = Overdue::Wall;
  enum class Look { kNotBehind, kBehind, kGivenUp };

  static constexpr std::chrono::milliseconds kLearning{20};
  static constexpr std::int64_t kMaxPeriod_ns = 250'000'000;

  /// A message with this stamp came at `time_ns`.
  void came(std::int64_t stamp_ns, std::int64_t time_ns) {
    if (!from_ns_) from_ns_ = time_ns;
    const bool teaches = stamp_ns >= *from_ns_ || time_ns - *from_ns_ > kMaxPeriod_ns;
    if (stamp_ns_ && teaches) {
      const std::int64_t apart_ns =
          std::clamp<std::int64_t>(stamp_ns - *stamp_ns_, 0, kMaxPeriod_ns);
      period_ns_ = counts() ? learned(apart_ns) : std::max(period_ns_, apart_ns);
      intervals_ = std::min(intervals_ + 1, kFirst);
    }
    stamp_ns_ = stamp_ns;
    came_ns_ = time_ns;
    overdue_.none();
    came_ = true;
  }

  /// Whether its next message is overdue by more than `lag_ns` at `time_ns`. One that is for too long is given up: it counts no
  /// more until it has been learnt again.
  Look look(std::int64_t time_ns, std::int64_t lag_ns, Wall::time_point now) {
    if (!stamp_ns_) return Look::kNotBehind;
    if (!counts()) {
      const bool ended = time_ns - came_ns_ > kMaxPeriod_ns;
      return ended || may_step(time_ns, now) ? Look::kNotBehind : Look::kBehind;
    }
    return look(time_ns - *stamp_ns_ - period_ns_ > lag_ns, now);
  }
  /// The same where somebody else knows whether it is overdue. Only of a topic that counts.
  Look look(bool overdue, Wall::time_point now) {
    if (!overdue) return Look::kNotBehind;
    if (!overdue_.give_up(now)) return Look::kBehind;
    *this = {};
    return Look::kGivenUp;
  }

  /// Whether its interval is known.
  bool counts() const { return intervals_ == kFirst; }

 private:
  static constexpr int kFirst = 4;  ///< The first may be short: a timer that was late catches up.
  static constexpr std::int64_t kGrowing = 16;
  static constexpr std::int64_t kForgetting = 64;

  /// While it is learnt.
  bool may_step(std::int64_t time_ns, Wall::time_point now) {
    if (time_ns != step_ns_) {
      step_ns_ = time_ns;
      stepped_ = now;
      came_ = false;
    }
    return came_ || now - stepped_ >= kLearning;
  }

  /// Messages come early after a late one, so it forgets slowly. One that is lost on the way must not let time run further
  /// ahead, or more are lost, and more again.
  std::int64_t learned(std::int64_t apart_ns) const {
    const std::int64_t more_ns = apart_ns - period_ns_;
    return period_ns_ + more_ns / (more_ns > 0 ? kGrowing : kForgetting);
  }

  std::optional<std::int64_t> from_ns_;   ///< When the first message came,
  std::optional<std::int64_t> stamp_ns_;  ///< the stamp of the last,
  std::int64_t came_ns_{};                ///< and when that came.
  std::int64_t period_ns_{};
  int intervals_{};  ///< Known, up to kFirst.
  Overdue overdue_;
  std::optional<std::int64_t> step_ns_;  ///< The step that time has made,
  Wall::time_point stepped_;             ///< when,
  bool came_{};                          ///< and whether a message has come since.
};

}  // namespace rosflight_sim
