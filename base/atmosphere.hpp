// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "base/constants.hpp"

/// Numbers of the standard atmosphere. The functions stand with their users, because the power
/// function differs: single precision in the firmware, the C library's in autonomy, the portable
/// one in the simulation.
namespace rosflight::base {

/// U.S. Standard Atmosphere 1976 (NOAA-S/T 76-1562), tables 2 and 4.
inline constexpr double kSeaLevelPressure_Pa = 101325.0;
inline constexpr double kSeaLevelTemperature_K = 288.15;
inline constexpr double kSeaLevelDensity_kg_m3 = 1.225;
inline constexpr double kGeopotentialRadius_m = 6356766.0;

/// A layer of constant lapse rate, up to the base of the next one.
struct AtmosphereLayer {
  double base_m;  ///< Geopotential altitude.
  double lapse_K_m;
};
inline constexpr std::array<AtmosphereLayer, 7> kAtmosphereLayers{{
    {0.0, -0.0065},
    {11000.0, 0.0},
    {20000.0, 0.001},
    {32000.0, 0.0028},
    {47000.0, 0.0},
    {51000.0, -0.0028},
    {71000.0, -0.002},
}};

/// The lowest layer (below 11 km) in closed form, p0 and rho0 being the values at sea level:
///
///     h   = scale (1 - (p/p0)^altitude_exponent)     (1)
///     rho = rho0 (p/p0)^density_exponent             (2)
///
/// with scale = T0/L, altitude_exponent = R L/g and density_exponent = 1 - R L/g.
struct Troposphere {
  double scale_m;
  double altitude_exponent;
  double pressure_exponent;  ///< The inverse of altitude_exponent.
  double density_exponent;
};
/// The standard's, rounded to six digits.
inline constexpr Troposphere kTroposphere{44330.77, 0.190263, 5.25588, 0.809737};
/// ROSflight 2.x's: the firmware's altitude and density are bit-equal with these.
inline constexpr Troposphere kRosflightTroposphere{44318.1386038261, 0.190326730028458, 5.2553,
                                                   0.809736894596450};

}  // namespace rosflight::base
