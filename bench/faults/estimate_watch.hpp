// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "bench/estimate_error.hpp"

namespace rosflight::bench::faults {

/// Does the estimate report how wrong it is? Counted from the begin of the first fault on, while the vehicle is
/// in the air by its true motion.
struct EstimateCount {
  std::uint64_t samples{};
  /// Those in which a state of kStates was outside its own 3 sigma.
  std::array<std::uint64_t, 9> outside{};
  std::uint64_t far{};      ///< Flights whose true position was off by more than 15 m.
  std::uint64_t in_time{};  ///< Those of them in which the estimate reported that within 10 s.
  std::uint64_t said{};     ///< Flights in which it reported an unreliable position.

  void add(const EstimateCount& other);
  /// Share of the samples outside, of the state that is outside most; and which it is.
  double worst_share() const;
  std::size_t worst() const;
};

/// Counts over one flight.
///
/// An error beyond 15 m is a case when the estimate reports it, or when it lasts for 10 s without that.
/// One that is smaller again before is none: nothing had to be reported. A flight counts once, by its
/// worst case. While nobody receives the estimate, as with a cut link, nothing is counted.
class EstimateWatch {
 public:
  /// The truth of so long before the first fault is needed: the estimate is that much late at most.
  static constexpr double kKept_s = 0.2;

  /// @param begin_s  when the first fault begins; 0 for a flight without.
  explicit EstimateWatch(double begin_s) : begin_s_{begin_s} {}

  /// In each step.
  void look(const flight::Flight& flight, sim::Time t);
  /// One sample. @param off_m  true error of the horizontal position.
  void sample(double t_s, const Eigen::Matrix<double, 9, 1>& sigmas, double off_m, bool unreliable);

  EstimateCount count() const;
  /// The vehicle had not taken off when the first fault began, by its true motion.
  bool began_before_lift_off() const { return began_before_lift_off_; }

 private:
  double begin_s_;
  TruePast past_;
  int step_{};
  bool begun_{};
  bool began_before_lift_off_{};
  EstimateCount count_;
  /// Off by more than 15 m without a report since then; < 0: it is not.
  double far_since_s_{-1.0};
  bool reported_{};  ///< A case was reported in time.
  bool late_{};      ///< A case was not.
  bool said_{};
};

}  // namespace rosflight::bench::faults
