// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Constants of mathematics and nature, each once in the tree. C++17, no dependency: firmware
/// takes its single-precision copies from here.
namespace rosflight::base {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kRadPerDeg = kPi / 180.0;
inline constexpr double kDegPerRad = 180.0 / kPi;

/// Standard gravity: 3rd General Conference on Weights and Measures (CGPM), 1901.
inline constexpr double kStandardGravity_m_s2 = 9.80665;

/// Universal gas constant over the molar mass of air: U.S. Standard Atmosphere 1976, table 2.
inline constexpr double kAirGasConstant_J_kg_K = 8314.32 / 28.9644;

/// Reference ellipsoid of satellite navigation (WGS 84): NGA.STND.0036 (2014), table 3.1.
namespace wgs84 {
inline constexpr double kSemiMajorAxis_m = 6378137.0;
inline constexpr double kFlattening = 1.0 / 298.257223563;
inline constexpr double kSemiMinorAxis_m = kSemiMajorAxis_m * (1.0 - kFlattening);
inline constexpr double kEccentricitySq = kFlattening * (2.0 - kFlattening);
inline constexpr double kSecondEccentricitySq = kEccentricitySq / (1.0 - kEccentricitySq);
}  // namespace wgs84

}  // namespace rosflight::base
