// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "firmware/core/test/flight_coverage.hpp"
#include "firmware/core/test/random_flight.hpp"

namespace rosflight::core {

/// Flies one random flight. @returns what did not hold, the first of each kind.
std::vector<Violation> fly_random(std::uint64_t seed, int passes, RandomFlight::Without without,
                                  Coverage& coverage);

/// The same failure with as few ingredients as it takes, and how to run it again.
std::string reduced(const Violation& violation);

/// Violations of many flights, by invariant: how many flights, and the first.
using Violations = std::map<std::string, std::pair<int, Violation>>;

/// Flies from seed `first` on.
Violations fly_many(std::uint64_t first, std::uint64_t flights, int passes, Coverage& coverage);

}  // namespace rosflight::core
