// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "flight/commander.hpp"
#include "flight/flight.hpp"
#include "flight/flight_summary.hpp"
#include "log/log_observer.hpp"

namespace rosflight::flight {

struct FlyOptions {
  FlightChoice choice;
  std::vector<std::string> arguments;  ///< As typed, for the summary.
  /// New or empty; default: the next number in flights/ of the current folder.
  std::optional<std::filesystem::path> folder;
  /// false: nothing is written, and there is no folder; allowed with `log` none.
  bool leave_folder{true};
  bool realtime{false};     ///< At the pace of the wall clock.
  double speed{1.0};        ///< With `realtime`: times the wall clock, > 0.
  std::string log{"plot"};  ///< How much the log holds: plot, full or none (log/README.md).
  /// Modules of your own; empty: the project's.
  std::function<FlightParts(const FlightSetup&)> parts;
  std::function<void(const FlightNote&)> on_note;  ///< Each note of the flight.
  std::function<void(const Flight&)> on_step;      ///< After each step.
  log::LogObserver* observer{nullptr};             ///< Sees what is logged; may be none.
  std::vector<sim::Visualiser*> visualisers;       ///< See the truth; must outlive the flight.
  Commander* commander{nullptr};                   ///< May be none.
  /// Asked before each step; true ends the flight, and its folder is written as of any other.
  std::function<bool()> interrupted;
};

/// The emulated autopilot failed during the flight.
class FlightAborted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Looks whether a flight can have its folder. @throws config::Error  there is one that is not empty.
void check_flight_folder(const std::filesystem::path& folder);
/// Makes a folder for a flight: `wanted`, or the next number in flights/ of the current folder.
/// @throws config::Error  it cannot be made, or is not empty.
std::filesystem::path make_flight_folder(const std::optional<std::filesystem::path>& wanted);

/// Flies a mission and leaves a flight folder: log, report, summary, checks before arming, vehicle, mission
/// and parameters.
/// @throws config::Error    bad input, a log without a folder, or the folder is not empty; nothing is written then.
/// @throws FlightAborted    the emulated autopilot failed; the log is not complete then.
/// @throws log::LogError    the log cannot be written.
FlightSummary fly(const FlyOptions& options);

}  // namespace rosflight::flight
