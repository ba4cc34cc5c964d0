// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace rosflight_sim {

/// Until when the ticks between two steps may go on before a message comes, of a node whose timer follows them.
///
/// Such a node stamps its message when its work is done, and rcl calls what is due again at once. If time went on by a period
/// during the work, two messages would have one stamp; so it stops shortly after the timer is due. The phase of the timer is that
/// of the earliest stamps and its period the mean of the intervals: a node that needs long stamps all its messages where time
/// stood, and a place learnt from those would go on and on. Whether its period is shorter is then found by stopping sooner.
class TimerPhase {
 public:
  using Wall = std::chrono::steady_clock;

  /// A message with this stamp came.
  void called(std::int64_t stamp_ns, std::int64_t tick_ns) {
    const auto apart_ns = static_cast<double>(stamp_ns - stamp_ns_);
    const bool gap = count_ > kFirst && apart_ns > kGap * period_ns_;
    if (gap && ++gaps_ > kMaxGaps) *this = {};  // another period
    if (count_ == 0 || gap) {
      due_ns_ = stamp_ns;
    } else {
      gaps_ = 0;
      const double periods = periods_in(apart_ns);
      learn(apart_ns / periods);
      const auto on_ns = static_cast<std::int64_t>(kLonger * periods * period_ns_);
      due_ns_ = std::clamp(due_ns_ + on_ns, stamp_ns - slack_ns(tick_ns), stamp_ns);
    }
    stamp_ns_ = stamp_ns;
    recent_ns_[static_cast<std::size_t>(count_) % recent_ns_.size()] = stamp_ns;
    count_ = count_ < kMaxCount ? count_ + 1 : kMean;
    stood_ = {};
    looked_.reset();
  }

  /// Whether the stamps are of ticks. Those of steps are of a node that follows these alone, those between two ticks of a sensor.
  bool follows(std::int64_t tick_ns, std::int64_t step_ns) const {
    const auto all_on = [&](std::int64_t apart_ns) {
      return std::all_of(recent_ns_.begin(), recent_ns_.end(),
                         [&](std::int64_t ns) { return ns % apart_ns == 0; });
    };
    return tick_ns > 0 && all_on(tick_ns) && !all_on(step_ns);
  }

  /// @param lag_ns  maximum after it is due
  std::int64_t ticks_end_ns(std::int64_t tick_ns, std::int64_t lag_ns) const {
    const Wall::duration late = std::max<Wall::duration>(stood_ - kBusy, {});
    const std::int64_t after_ns = slack_ns(tick_ns) + late / kPerTick * tick_ns;
    return next_ns() + std::min(after_ns, std::max(lag_ns, kMinSlack * tick_ns));
  }

  /// Time stands there. A timer that is due later than was thought is found by going on slowly.
  void stands(Wall::time_point now) {
    if (looked_) stood_ += std::min<Wall::duration>(now - *looked_, kPerTick);
    looked_ = now;
  }

 private:
  static constexpr int kFirst = 8;
  static constexpr int kMean = 64;
  static constexpr int kMaxCount = 1 << 20;
  static constexpr int kMaxGaps = 4;
  static constexpr double kGap = 2.5;           ///< Periods: it was not called meanwhile.
  static constexpr std::int64_t kMinSlack = 3;  ///< Ticks.
  static constexpr auto kBusy = std::chrono::milliseconds(20);    ///< What its work may take.
  static constexpr auto kSlow = std::chrono::milliseconds(2);     ///< Time stood so long for it.
  static constexpr auto kPerTick = std::chrono::milliseconds(5);  ///< When it needs more than that.
  /// A period that is thought too short makes time stand; one that is too long is put right by the next stamp.
  static constexpr double kLonger = 1.001;
  /// Some hundred messages until the period of a slow node is found from above; time then stands for kBusy once.
  static constexpr double kShorter = 1.0 - 1.0 / 1024;

  /// Half a period keeps no node waiting that is as fast as it should be. For one that is slow, where time stands decides its
  /// stamps, and must not come near the next call.
  std::int64_t slack_ns(std::int64_t tick_ns) const {
    const auto half_ns = static_cast<std::int64_t>(period_ns_ / 2);
    return std::max(slow_ > 0 ? 0 : half_ns, kMinSlack * tick_ns);
  }

  /// More than one where a call was left out or its message lost. A node that was waited for in vain has another period.
  double periods_in(double apart_ns) const {
    const bool known = count_ > kFirst && stood_ <= kBusy;
    return known ? std::max(1.0, std::round(apart_ns / period_ns_)) : 1.0;
  }

  void learn(double apart_ns) {
    if (count_ <= kFirst)  // the first may be short: a timer that was late catches up
      period_ns_ = std::max(period_ns_, apart_ns);
    else
      period_ns_ += (apart_ns - period_ns_) / std::min(count_, kMean);
    const bool slow = stood_ > kSlow && stood_ <= kBusy;
    slow_ = slow ? kMean : std::max(slow_ - 1, 0);
    if (stood_ > kBusy) {  // the period was too short
      period_ns_ = std::max(period_ns_, apart_ns);
      count_ = kFirst;
    } else if (slow) {  // as long as time was given, or shorter
      period_ns_ *= kShorter;
    }
  }

  std::int64_t next_ns() const { return due_ns_ + static_cast<std::int64_t>(kLonger * period_ns_); }

  std::int64_t stamp_ns_{};
  std::array<std::int64_t, 8> recent_ns_{};
  std::int64_t due_ns_{};  ///< When it was due at the last call.
  double period_ns_{};
  int count_{};
  int gaps_{};  ///< One after the other.
  int slow_{};  ///< Messages until it counts as fast.
  Wall::duration stood_{};
  std::optional<Wall::time_point> looked_;
};

}  // namespace rosflight_sim
