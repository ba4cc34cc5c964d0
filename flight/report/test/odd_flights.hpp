// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string_view>

#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// Flights that go wrong in ways a report must survive: "empty" (nothing at all), "one" (a single
/// sample), "nan" (samples of nothing but time), "wild" (infinite and enormous values, times that
/// stand still), "hostile" (markup, script and broken UTF-8 in every text), "chatter" (states and
/// events by the thousand).
FlightRecord odd_flight(std::string_view kind);

inline constexpr std::array<std::string_view, 6> kOddFlights{"empty", "one",     "nan",
                                                             "wild",  "hostile", "chatter"};

}  // namespace rosflight::report
