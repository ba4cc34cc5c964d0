// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench/faults/estimate_watch.hpp"
#include "bench/faults/rules.hpp"

namespace rosflight::bench::faults {

/// One flight that has been flown.
struct Flown {
  Case flight;
  std::vector<std::string> faults;  ///< As `./rosflight fly --fault` takes them.
  Class ended{};
  std::string verdict;     ///< One sentence.
  double touchdown_m_s{};  ///< NaN: none.
  double from_aim_m{};     ///< NaN: none.
  double sim_time_s{};
  EstimateCount estimate{};
  std::string
      without_faults;  ///< Outcome of an unexplained random flight flown without its faults.
  bool as_asked() const { return explained(flight, ended); }
};

/// The command that flies this again, equal to the bit.
std::string command(const Flown& flown);

struct Campaign {
  std::vector<Flown> flights;  ///< In the order of the cases.
  std::size_t nominal{};  ///< Flights without faults that were flown for the times of the phases.
  std::size_t nominal_said{};  ///< Those in which the estimate reported an unreliable position.
};

/// Flies all cases, several at once, without logs. The result is that of flying each one alone from
/// its power-up, in the order of the cases: flights that are equal until their fault fly this part
/// once. An unexplained random flight is flown again without its faults. Call it while the process has one thread.
/// @param processes  children to fly in; 0: one for each processor.
/// @param progress   called after each flight with the number of flights done.
Campaign fly(const std::vector<Case>& cases, unsigned processes,
             const std::function<void(std::size_t)>& progress);

}  // namespace rosflight::bench::faults
