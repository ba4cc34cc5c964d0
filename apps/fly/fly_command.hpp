// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>

#include "apps/fly/flight_setup.hpp"
#include "apps/fly/guide.hpp"

namespace rosflight::apps {

struct FlyOptions {
  FlightChoice choice;
  std::optional<std::filesystem::path>
      out;  ///< Flight folder; default: the next number in flights/.
  bool realtime{false};
  bool json{false};
  /// Guidance of your own instead of the project's.
  std::function<std::unique_ptr<Guide>(const FlightSetup&)> guide;
};

/// `./rosflight fly`: flies, leaves a flight folder, says how it went. Results go to `out`,
/// progress to `err`. @returns 0, or 1 if the mission failed or the emulated board died. @throws
/// config::Error and log::LogError for bad input and a full disk; then there is no folder that
/// looks complete.
int fly_command(const FlyOptions& options, std::ostream& out, std::ostream& err);

}  // namespace rosflight::apps
