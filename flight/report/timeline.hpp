// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// Appends the state timeline as a figure: one band per lane with its states written into it, one
/// row of reached waypoints, one of faults, one of events; on the time axis the charts below it
/// use.
void append_timeline(std::string& html, const FlightRecord& record);

/// Events shown, here and in the table of the report: the first so many. The log has them all.
inline constexpr std::size_t kMostEvents = 500;

/// CSS class of a tone: "neutral", "good", "note", "warning", "bad".
std::string_view tone_class(Tone tone);

}  // namespace rosflight::report
