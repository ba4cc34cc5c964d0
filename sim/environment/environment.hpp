// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "base/constants.hpp"
#include "config/strict_yaml.hpp"
#include "sim/environment/atmosphere.hpp"
#include "sim/environment/geodesy.hpp"
#include "sim/environment/wind.hpp"

namespace rosflight::sim {

/// Position and date: section `environment` of a vehicle file.
struct EnvironmentParameters {
  Geodetic origin;              ///< Origin of the local frame W; height above mean sea level.
  std::int64_t start_unix_s{};  ///< Civil time at simulation time 0.
  double gravity_m_s2{base::kStandardGravity_m_s2};
  AtmosphereParameters atmosphere;
  WindParameters wind;
  /// At the origin [T]; from WMM2025 for origin and day, or as given.
  Vector3 magnetic_field_W_T{Vector3::Zero()};
};

/// Reads and checks the section; throws config::Error. Keys and their limits:
/// docs/design/physics.md.
EnvironmentParameters read_environment(const config::Section& section);

/// Seconds since 1970-01-01 of "YYYY-MM-DDThh:mm:ssZ"; nothing for any other text or an impossible
/// date.
std::optional<std::int64_t> parse_utc(std::string_view text);

}  // namespace rosflight::sim
