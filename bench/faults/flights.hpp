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

/// Flies all cases, several at once, in this process and without logs. The result is that of flying
/// one after the other, in the order of the cases. An unexplained random flight is flown again without its faults.
/// @param threads   0: one for each processor.
/// @param progress  called now and then with the number of flights done, by one thread at a time.
Campaign fly(const std::vector<Case>& cases, unsigned threads,
             const std::function<void(std::size_t)>& progress);

}  // namespace rosflight::bench::faults
