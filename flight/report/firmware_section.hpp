// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// Appends what the firmware counted and how it filtered the gyro; nothing if neither is known.
void append_firmware_section(std::string& html, const FlightRecord& record);

}  // namespace rosflight::report
