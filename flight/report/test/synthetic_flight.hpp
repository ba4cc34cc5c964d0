// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// A flight that looks like one, without a simulation: quintic legs between waypoints flown with a
/// lag, noise, a gust, a sagging battery, states, events, a fault and a missed waypoint. For tests
/// and for looking at.
/// @param interval_s  Of the samples; the flight lasts about a minute.
FlightRecord synthetic_flight(double interval_s);

}  // namespace rosflight::report
