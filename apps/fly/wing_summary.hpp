// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string>

#include "apps/fly/wing_record.hpp"
#include "apps/report/flight_record.hpp"

namespace rosflight::apps {

/// What only a fixed wing has, as further entries of the summary; nothing for a null pointer.
std::string wing_json(const WingRecord* wing);
/// The same as lines for people,
void print_wing(std::ostream& out, const WingRecord& wing);
/// and as headlines of the report.
void add_wing_facts(report::FlightRecord& record, const WingRecord& wing);

}  // namespace rosflight::apps
