// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

namespace rosflight_sim {

/// Times between two steps of simulated time, published at the wall times that belong to them.
///
/// A node that asks twice within one step of 2.5 ms should find two times. In a thread of its own, because the wait set of a
/// process with many nodes is too slow to wake up 10 000 times a second. A tick that is late is left out here; late steps are the
/// time manager's.
class FineTicks {
 public:
  using Wall = std::chrono::steady_clock;
  /// Ticks closer than this in wall time are left out.
  static constexpr std::chrono::microseconds kMinGap{50};

  /// A step that has just been published, and the ticks up to the next one.
  struct Step {
    std::int64_t time_ns{};                                         ///< Time of the step.
    std::int64_t step_ns{};                                         ///< From it to the next.
    std::int64_t tick_ns{};                                         ///< Between two ticks.
    Wall::time_point wall{};                                        ///< Time of the step.
    Wall::duration wall_period{};                                   ///< From it to the next.
    std::int64_t end_ns{std::numeric_limits<std::int64_t>::max()};  ///< No tick after this time.
  };

  /// @param tell  called in the thread with a time [ns] between two steps; may come after the next step, which is then newer.
  explicit FineTicks(std::function<void(std::int64_t)> tell)
      : tell_{std::move(tell)}, thread_{[this] { run(); }} {}
  ~FineTicks() {
    {
      const std::lock_guard lock{mutex_};
      ended_ = true;
      ++number_;
    }
    changed_.notify_one();
    thread_.join();
  }
  FineTicks(const FineTicks&) = delete;
  FineTicks& operator=(const FineTicks&) = delete;

  /// Goes on from this step, or with the rest of it.
  void follow(const Step& step) { set(step); }
  /// No more ticks until follow().
  void stop() { set({}); }

  /// Number of the first tick after `last` that is still to come at `now`, or of the last one before an end that has been reached;
  /// 0 if there is none before the next step.
  static std::int64_t next(const Step& step, std::int64_t last, Wall::time_point now) {
    if (step.tick_ns <= 0 || step.step_ns <= step.tick_ns) return 0;
    const auto gap = wall_gap(step);
    const std::int64_t stride = gap >= kMinGap ? 1 : kMinGap / std::max(gap, Wall::duration{1}) + 1;
    const std::int64_t passed =
        now <= step.wall || gap <= Wall::duration{0} ? 0 : (now - step.wall) / gap;
    const bool ends = step.end_ns < step.time_ns + step.step_ns;
    const std::int64_t end = ends ? (step.end_ns - step.time_ns) / step.tick_ns : 0;
    const std::int64_t coming = std::max(last + stride, passed);
    const std::int64_t number = ends ? std::min(coming, end) : coming;
    return number > last && number * step.tick_ns < step.step_ns ? number : 0;
  }
  static Wall::time_point due(const Step& step, std::int64_t number) {
    return step.wall + number * wall_gap(step);
  }

 private:
  static Wall::duration wall_gap(const Step& step) {
    return step.wall_period * step.tick_ns / step.step_ns;
  }

  void set(const Step& step) {
    {
      const std::lock_guard lock{mutex_};
      if (step_.tick_ns == 0 && step.tick_ns == 0) return;  // nothing to wake the thread for
      step_ = step;
      ++number_;
    }
    changed_.notify_one();
  }

  void run() {
    std::unique_lock lock{mutex_};
    std::uint64_t followed = 0;
    std::int64_t told_ns = 0;
    while (!ended_) {
      changed_.wait(lock, [&] { return number_ != followed; });
      followed = number_;
      const Step step = step_;
      std::int64_t tick =
          step.tick_ns > 0 ? std::max<std::int64_t>(told_ns - step.time_ns, 0) / step.tick_ns : 0;
      while ((tick = next(step, tick, Wall::now())) > 0) {
        if (changed_.wait_until(lock, due(step, tick), [&] { return number_ != followed; })) break;
        told_ns = step.time_ns + tick * step.tick_ns;
        lock.unlock();
        tell_(told_ns);
        lock.lock();
        if (number_ != followed) break;
      }
    }
  }

  std::function<void(std::int64_t)> tell_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Step step_{};
  std::uint64_t number_{0};  ///< Number of calls of set().
  bool ended_{false};
  std::thread thread_;
};

}  // namespace rosflight_sim
