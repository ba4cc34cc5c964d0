// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>

#include "base/atmosphere.hpp"

namespace rosflight::sim {

enum class AtmosphereModel {
  kStandard1976,  ///< US Standard Atmosphere 1976, shifted by the offsets below.
  kReference,     ///< The formulas of ROSflight 2.x's simulated barometer.
  kConstant       ///< Density fixed, pressure and temperature of the standard.
};

struct AtmosphereParameters {
  AtmosphereModel model{AtmosphereModel::kStandard1976};
  /// Pressure of the day; by default that of the standard.
  double sea_level_pressure_Pa{base::kSeaLevelPressure_Pa};
  double temperature_offset_K{0.0};  ///< Warmer (+) or colder than the standard, at all altitudes.
  double constant_density_kg_m3{base::kSeaLevelDensity_kg_m3};  ///< Only with kConstant.
};

struct AirProperties {
  double pressure_Pa;
  double temperature_K;
  double density_kg_m3;
};

/// Air at rest as a function of altitude.
///
/// Standard (U.S. Standard Atmosphere, 1976, NOAA-S/T 76-1562; equations by its numbers):
/// geopotential height H = r0 h / (r0 + h) (18); in layer b, T = T_b + L_b (H - H_b) (23) and
///
///     p = p_b (T / T_b)^(-g0 / (R L_b))         L_b != 0    (33a)
///     p = p_b exp(-g0 (H - H_b) / (R T_b))      L_b  = 0    (33b)
///     rho = p / (R T)                                       (42)
///
/// with R = R*/M0 = 287.053 J/(kg K). A temperature offset changes every T_b, and the pressures at
/// the bottoms of the layers follow, so the air stays in hydrostatic balance. Seven layers, 0 to
/// 84.8 km geopotential; the outer ones are continued down to -10 and up to 1000 km, and constant
/// beyond.
///
/// Reference: p = 101325 (1 - 2.25694e-5 h)^5.2553, rho = 1.225 (p/101325)^0.809736894596450,
/// T = 300.15 K.
///
/// One exp and at most one log a call (sim/portable_math.hpp): the same bits on every machine,
/// about 30 ns.
class Atmosphere {
 public:
  /// Computes the pressures at the bottoms of the layers.
  explicit Atmosphere(const AtmosphereParameters& parameters = {});

  /// @param height_m  geometric, above mean sea level.
  AirProperties at(double height_m) const;

 private:
  static constexpr std::size_t kLayers = 7;
  struct Layer {
    double base_m;  ///< Geopotential.
    double lapse_K_m;
    double temperature_K;  ///< At the base.
    double pressure_Pa;    ///< At the base.
    double exponent;       ///< -g0/(R L), or -g0/(R T) [1/m] where L = 0.
  };
  AirProperties standard(double height_m) const;

  AtmosphereParameters parameters_;
  std::array<Layer, kLayers> layers_;
};

}  // namespace rosflight::sim
