// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// Appends the errors of the estimate inside their 3 sigma, and the innovations of every aid that
/// was used.
void append_estimate_charts(std::string& html, const FlightRecord& record);

/// Appends what a fixed wing follows: cross-track and height error, airspeed, course, wind,
/// surfaces.
void append_wing_charts(std::string& html, const FlightRecord& record);

}  // namespace rosflight::report
