// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "flight/flight.hpp"

namespace rosflight::flight {

/// A change of a running flight, as a person writes it and as the log has it:
///
///     wind SPEED,FROM_DEG[,W20]         as --wind, from now on
///     gust SPEED,FROM_DEG,SECONDS       one gust, one minus cosine
///     fault WHAT[=VALUE][:DURATION]     as --fault, from now on
///     heal                              all faults end
///     switch NAME on|off                arm, attitude_override, throttle_override, attitude_mode
///     stick NAME POSITION               roll, pitch, throttle, yaw; 0 to 1
///     keep_altitude on|off              the pilot of a multirotor keeps its altitude by the throttle stick
///     altitude_offset METRES            a multirotor flies its mission this much higher, -3 to 3
///     hold on|off                       the pilot does not arm by himself
///     board slow|reversed_clock|healthy passes of 3 ms; samples whose stamps go back (board in process)
///     land | return                     the mission ends
///     tune KEY VALUE                    a key of the section autonomy, but for the estimator's
///
/// The same changes in the same steps give the same flight to the bit.
/// @param present  the flight as it is. @returns what does it at the beginning of a step, before the firmware runs.
/// @throws config::Error  one line: what was found and what is allowed.
std::function<void(Flight&)> parse_change(const std::string& text, const Flight& present);

}  // namespace rosflight::flight
