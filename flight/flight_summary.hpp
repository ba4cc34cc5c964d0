// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "flight/flight.hpp"
#include "link/messages.hpp"
#include "log/flight_log.hpp"

namespace rosflight::flight {

/// How a recorded flight went.
struct FlightSummary {
  FlightChoice choice;
  std::vector<std::string> arguments;        ///< As typed.
  std::vector<std::string> faults_too_late;  ///< Faults after the end of the flight.
  std::filesystem::path folder;
  FlightScore score;
  double sim_time_s{};
  double flight_time_s{};    ///< Since arming.
  double wall_time_s{};      ///< Log included.
  ErrorStatistics tracking;  ///< See Flight.
  ErrorStatistics own_tracking;
  std::optional<FixedWingRecord> fixedwing;  ///< Empty for a multirotor.
  bool landed{};
  bool disarmed{};
  int warnings{};  ///< Notes of this severity in flight.
  int errors{};
  std::uint64_t frames_dropped{};             ///< Frames that found no room on the link.
  std::optional<ProcessorFigures> processor;  ///< Figures of an emulated processor.
  double gyro_latency_s{std::numeric_limits<double>::quiet_NaN()};  ///< Gyro filters.
  std::optional<link::Counters> counters;         ///< The firmware's newest report.
  std::optional<rosflight::log::LogSummary> log;  ///< Empty without a log.
  std::filesystem::path page;                     ///< report.html; empty: none was written.

  double realtime_factor() const { return wall_time_s > 0.0 ? sim_time_s / wall_time_s : 0.0; }
};

/// The summary of a flight that has ended. Empty: folder, wall_time_s, log and what the recorder
/// counts. @param interrupted  a person stopped it.
FlightSummary summarise(const Flight& flight, bool interrupted = false);

/// The command that flies this again, without options of output.
std::string command_line(const FlightChoice& choice);

/// One JSON object in one line, as `./rosflight fly --json` prints it.
std::string summary_json(const FlightSummary& summary);

}  // namespace rosflight::flight
