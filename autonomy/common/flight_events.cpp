// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/flight_events.hpp"

#include "autonomy/common/phase_table.hpp"

namespace rosflight::autonomy {
namespace {

constexpr std::array<const char*, 25> kNames{
    "phase",
    "waypoint reached",
    "waypoint missed",
    "mission done",
    "take-off failed",
    "no path leads on from here",
    "motor out",
    "position lost",
    "pilot took over",
    "pilot gave back",
    "state lost",
    "state regained",
    "the vehicle does not follow its thrust: landing; compare the vehicle file with its motors",
    "battery low",
    "battery low: returns",
    "battery low: lands",
    "outside of the fence: returns",
    "receiver lost: the flight controller flies its failsafe command",
    "the flight controller follows commands again",
    "returns to the start",
    "the ailerons have no effect: the rudder rolls",
    "no state: sinks level",
    "no state: glides with level wings",
    "back after more than 10 s: holds 8 s, then returns and lands",
    "link and receiver are back: takes off again"};

}  // namespace

const char* name(FlightEventType type) {
  return name_in(kNames, static_cast<std::size_t>(type));
}

}  // namespace rosflight::autonomy
