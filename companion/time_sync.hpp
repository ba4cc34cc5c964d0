// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "companion/time.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// Maps the FCU's boot clock to companion time from TIMESYNC exchanges.
///
/// A request is sent at t_s, the FCU reads its clock t_c, and the answer is received at t_r. Then
///
///     round trip  r = t_r - t_s                                                           (1)
///     offset      o = (t_s + t_r)/2 - t_c                                                 (2)
///     error       |o - O| <= r/2   for the true offset O and any split of the delay       (3)
///
/// kMinimumDelay (default): per second the exchange with the smallest r is kept (the clock filter
/// of NTP, RFC 5905 sec. 10). A straight line, offset against FCU time, is fitted to the last 16 of
/// them by least squares with weights 1/(s^2 + ((r - r_min)/2)^2), s = 20 us; its slope is
/// the drift, fixed at zero until the points span 4 s and kept within 500 ppm (crystals are good
/// for 100 ppm). A clock jump violates (3): |o - O| > r/2 + r_min/2 + 5 ms, twice in a row.
///
/// kRosflight2, for comparison: the rule of ROSflight 2.x. The first offset and jumps above 10 ms are
/// used unchanged, else O <- 0.95 o + 0.05 O.
///
/// The asymmetry of the delays cannot be observed; error_bound is the largest error it can cause.
class TimeSync {
 public:
  enum class Rule : std::uint8_t { kMinimumDelay, kRosflight2 };
  enum class Answer : std::uint8_t { kIgnored, kAccepted, kJumped };

  struct Figures {
    std::uint64_t requests{};
    std::uint64_t answers{};
    std::uint64_t ignored{};  ///< Answers to others, over 16 requests late, doubled or impossible.
    std::uint64_t jumps{};
    Time offset{};       ///< At the last answer: companion time - FCU time.
    double drift_ppm{};  ///< Rate of the companion clock against the FCU's, minus one.
    Time round_trip{};   ///< Round trip of the last answer.
    Time min_round_trip{};
    Time jitter{};       ///< Root mean square of o - O, exponential over some 20 answers.
    Time error_bound{};  ///< Half the smallest round trip: (3).
  };

  /// @param rule  that determines the offset.
  explicit TimeSync(Rule rule = Rule::kMinimumDelay) : rule_(rule) {}

  /// A request to send at `now`.
  link::TimeSync request(Time now);
  /// Processes an answer that was received at `now`.
  Answer answer(const link::TimeSync& message, Time now);
  /// Discards the offset after a restart of the FCU; counters are kept.
  void reset();

  bool synchronised() const { return synchronised_; }
  /// Companion time of an FCU time. Only meaningful when synchronised().
  Time to_companion(Time fcu) const;
  const Figures& figures() const { return figures_; }

 private:
  struct Point {
    Time fcu{};
    Time offset{};
    Time round_trip{};
  };
  static constexpr std::size_t kPoints = 16;
  static constexpr std::size_t kOutstanding = 16;

  bool is_ours(Time sent);
  bool contradicts(const Point& point) const;
  void restart_from(const Point& point);
  void insert(const Point& point);
  void fit();
  void apply_rosflight2_rule(const Point& point);
  void measure(const Point& point);

  Rule rule_;
  bool synchronised_{false};
  std::array<Time, kOutstanding> sent_{};  ///< Zero: free or answered.
  std::size_t next_sent_{0};
  std::array<Point, kPoints> points_{};  ///< Ring; the newest is still collecting its second.
  std::size_t count_{0};
  std::size_t newest_{0};
  Time newest_since_{};
  std::optional<Point> suspect_;
  Time base_fcu_{};  ///< Offset line: offset_ at base_fcu_, slope_ from there.
  Time offset_{};
  double slope_{0.0};
  double mean_square_ns2_{0.0};
  Figures figures_;
};

}  // namespace rosflight::companion
