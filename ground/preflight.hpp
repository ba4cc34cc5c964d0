// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "ground/ground_link.hpp"

namespace rosflight::ground {

/// What was received from a vehicle before the checks are judged.
struct PreflightFacts {
  link::Status status;
  companion::Streams streams;
  std::vector<link::CheckResult> checks;  ///< The list of the firmware; empty if it sends none.
  companion::ParameterSet parameters;     ///< Those of preflight_parameters() that the vehicle has.
  companion::LinkStatistics link;
  bool synchronised{};
  double drift_ppm{};
  std::string firmware;
  companion::VersionMatch version{companion::VersionMatch::kUnreadable};
};

enum class PreflightVerdict : std::uint8_t {
  kPass,
  kWarning,  ///< Does not keep the vehicle on the ground.
  kFail,
  kNotTold  ///< The link carries nothing that would answer it.
};

struct PreflightRow {
  std::string name;
  PreflightVerdict verdict{};
  std::string text;
};

/// Judges what was received: the firmware's own list first, from the error word of the status where the
/// firmware sends no list; then link, sensors, calibrations and parameters.
std::vector<PreflightRow> judge_preflight(const PreflightFacts& facts);

/// Names of the parameters that the checks read.
std::span<const char* const> preflight_parameters();

/// Observes a connected vehicle for some seconds. @throws Stopped
PreflightFacts observe_preflight(GroundLink& link);

/// Prints a table, or JSON. @returns the exit code: 0, or 1 if a row fails.
int print_preflight(const std::vector<PreflightRow>& rows, bool json, std::ostream& out);

}  // namespace rosflight::ground
