// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>
#include <vector>

#include "companion/record_reader.hpp"
#include "firmware/boards/parts/flight_record.hpp"
#include "ground/ground_link.hpp"

namespace rosflight::ground {

/// An entry of a board's flight record on one time axis: the clock of the board starts again at 0 with each start,
/// this time goes on. The pause of a restart is not known and counts as 0.
struct RecordedEntry {
  double time_s{};  ///< Since the first entry.
  boards::parts::FlightRecord::Entry entry;
};

/// Decodes what a reader received; damaged entries are left out.
std::vector<RecordedEntry> decode_record(
    const std::map<std::uint32_t, companion::RecordReader::Bytes>& entries);

/// Writes a flight folder: flight.mcap with the topics of a flight, record.csv with one row a moment,
/// texts.csv. @throws FileError, LogError
void write_record(const std::vector<RecordedEntry>& record, const std::filesystem::path& folder);

/// ./rosflight blackbox: reads the flight record of a connected vehicle into a folder that is new or empty.
/// @returns the exit code: 1 if there is no record or it could not be read to its end.
int read_blackbox(GroundLink& link, const std::filesystem::path& folder, std::ostream& out);

}  // namespace rosflight::ground
