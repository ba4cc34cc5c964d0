// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// Appends every chart over time: position and its error, speed, what a fixed wing follows, the
/// estimate, attitude beside rates, motors, battery.
void append_flight_charts(std::string& html, const FlightRecord& record);

/// Yaw angles without the jumps at half turns [rad]. `follow`: each value is moved by whole turns
/// to within half a turn of the finite value of `follow` at the same index, otherwise of its own
/// predecessor.
std::vector<double> unwrapped(std::vector<double> angles,
                              const std::vector<double>* follow = nullptr);

}  // namespace rosflight::report
