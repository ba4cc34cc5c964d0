// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "bench/faults/flights.hpp"

/// The campaign for people: a table for the terminal, rows for other programs, a page.
namespace rosflight::bench::faults {

/// The verdict of a flight; of an unexplained random one also how it ends without its faults.
std::string verdict(const Flown& flown);
/// The matrices fault x phase, the summary of the pairs, and every flight that no rule explains.
std::string as_text(const std::vector<Flown>& flown);
/// Random flights: how many ended how, and every flight that no rule explains.
std::string as_random_text(const std::vector<Flown>& flown);
/// A header and one row for each flight.
std::string as_csv(const std::vector<Flown>& flown);
/// docs/fault-matrix.md.
std::string as_page(const std::vector<Flown>& flown);

/// A flight that the page describes otherwise, or does not describe, one line each.
/// @param page  as as_page() made it of a whole campaign.
std::vector<std::string> differences(const std::vector<Flown>& flown, const std::string& page);

}  // namespace rosflight::bench::faults
