// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/fly.hpp"
#include "flight/report/flight_record.hpp"

namespace rosflight::flight {

/// Adds to the record of a flight what the report shows besides curves: title, verdict, facts,
/// faults, changed parameters and the command that repeats the flight.
void add_summary(report::FlightRecord& record, const FlightSetup& setup,
                 const FlightSummary& summary, const FlyOptions& options);

}  // namespace rosflight::flight
