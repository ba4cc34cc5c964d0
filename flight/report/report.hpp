// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

#include "flight/report/flight_record.hpp"

namespace rosflight::report {

/// The report as one HTML page that needs nothing else: styles, drawings and scripts are inside,
/// nothing is fetched. Readable without scripts, on light and dark screens, and printed. Its size
/// depends on the width of the charts, not on the length of the flight; everything that came from
/// files or texts is escaped.
std::string report_html(const FlightRecord& record);

/// Writes report_html() to a file, complete or not at all. @throws base::FileError if it cannot.
void write_report(const FlightRecord& record, const std::filesystem::path& path);

}  // namespace rosflight::report
