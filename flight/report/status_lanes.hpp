// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "flight/report/flight_record.hpp"
#include "link/messages.hpp"

namespace rosflight::report {

/// Enters the firmware's status, as it came over the link at t_s, into the lanes "Firmware"
/// (disarmed, armed, failsafe), "Control" (who flies), "Override" (why the pilot does) and
/// "Errors". Bits: Status message of ROSflight 2.x.
void record_status(FlightRecord& record, double t_s, const link::Status& status);

/// Error bits in words: "RC lost, IMU silent"; empty for 0.
std::string error_names(std::uint8_t error_code);

/// Bits 0..5 of rc_override in words: "attitude switch, roll stick"; empty if the pilot does not
/// override.
std::string override_names(std::uint16_t rc_override);

}  // namespace rosflight::report
