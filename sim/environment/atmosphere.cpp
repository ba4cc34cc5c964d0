// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/atmosphere.hpp"

#include <algorithm>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

/// Where the layers would have to be continued too far.
constexpr double kMinHeight_m = -10e3;
constexpr double kMaxHeight_m = 1000e3;

double pressure_ratio(double exponent, double lapse_K_m, double temperature_ratio,
                      double above_base_m) {
  return lapse_K_m == 0.0 ? portable::exp(exponent * above_base_m)
                          : portable::exp(exponent * portable::log(temperature_ratio));
}

}  // namespace

Atmosphere::Atmosphere(const AtmosphereParameters& parameters)
    : parameters_{parameters}, layers_{} {
  double temperature = base::kSeaLevelTemperature_K + parameters.temperature_offset_K;
  double pressure = parameters.sea_level_pressure_Pa;
  for (std::size_t i = 0; i < kLayers; ++i) {
    const auto [base_m, lapse] = base::kAtmosphereLayers[i];
    const double slope = lapse == 0.0 ? temperature : lapse;
    const Layer layer{base_m, lapse, temperature, pressure,
                      -base::kStandardGravity_m_s2 / (base::kAirGasConstant_J_kg_K * slope)};
    layers_[i] = layer;
    if (i + 1 < kLayers) {
      const double thickness = base::kAtmosphereLayers[i + 1].base_m - base_m;
      temperature += lapse * thickness;
      pressure *=
          pressure_ratio(layer.exponent, lapse, temperature / layer.temperature_K, thickness);
    }
  }
}

AirProperties Atmosphere::standard(double height_m) const {
  const double geopotential =
      base::kGeopotentialRadius_m * height_m / (base::kGeopotentialRadius_m + height_m);
  std::size_t i = 0;
  while (i + 1 < kLayers && geopotential >= layers_[i + 1].base_m) ++i;
  const Layer& layer = layers_[i];
  const double above = geopotential - layer.base_m;
  // Far above the last layer its lapse would lead to negative temperatures.
  const double temperature = std::max(layer.temperature_K + layer.lapse_K_m * above, 1.0);
  const double pressure =
      layer.pressure_Pa *
      pressure_ratio(layer.exponent, layer.lapse_K_m, temperature / layer.temperature_K, above);
  return {pressure, temperature, pressure / (base::kAirGasConstant_J_kg_K * temperature)};
}

AirProperties Atmosphere::at(double height_m) const {
  height_m =
      height_m > kMinHeight_m ? std::min(height_m, kMaxHeight_m) : kMinHeight_m;  // also for a NaN
  if (parameters_.model == AtmosphereModel::kReference) {
    constexpr const base::Troposphere& air = base::kRosflightTroposphere;
    const double share = std::max(1.0 - 2.25694e-5 * height_m, 1e-6);
    const double log_ratio = air.pressure_exponent * portable::log(share);
    return {base::kSeaLevelPressure_Pa * portable::exp(log_ratio), 300.15,
            base::kSeaLevelDensity_kg_m3 * portable::exp(air.density_exponent * log_ratio)};
  }
  AirProperties air = standard(height_m);
  if (parameters_.model == AtmosphereModel::kConstant)
    air.density_kg_m3 = parameters_.constant_density_kg_m3;
  return air;
}

}  // namespace rosflight::sim
