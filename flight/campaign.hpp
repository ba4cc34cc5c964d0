// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "flight/flight_summary.hpp"

namespace rosflight::flight {

struct CampaignOptions {
  FlightChoice choice;  ///< Choice of all flights; its seed is not used.
  std::uint64_t first_seed{1};
  std::uint64_t last_seed{1};  ///< Included.
  unsigned threads{0};         ///< Flights at once; 0: one for each processor.
  /// Called after each flight, by one thread at a time: flights done so far.
  std::function<void(std::size_t)> on_flight;
  /// Asked before each step by every thread, at the same time; true ends the campaign, and flights that have
  /// not ended do not count.
  std::function<bool()> interrupted;
};

/// Flies the same flight with many seeds, several at once, without logs. The result is that of the
/// flights one after the other, whatever the number of threads.
/// @returns the flights that have ended, in the order of their seeds.
/// @throws config::Error  bad input, or boards that fly in real time or are emulated.
std::vector<FlightSummary> fly_campaign(const CampaignOptions& options);

/// A header and one row for each flight; no value: an empty cell.
std::string campaign_csv(const std::vector<FlightSummary>& flights);

/// "1:100", or one seed. @throws config::Error.
void read_seeds(const std::string& text, CampaignOptions& options);

}  // namespace rosflight::flight
