// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/atmosphere.hpp"

#include <algorithm>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

// U.S. Standard Atmosphere 1976, tables 2 and 4.
constexpr double kEarthRadius_m = 6356766.0;
constexpr double kGravity_m_s2 = 9.80665;
constexpr double kGasConstant_J_kg_K = 8314.32 / 28.9644;
constexpr double kSeaLevelTemperature_K = 288.15;
/// Where the layers would have to be continued too far.
constexpr double kLowest_m = -10e3;
constexpr double kHighest_m = 1000e3;
struct StandardLayer {
  double base_m;
  double lapse_K_m;
};
constexpr std::array<StandardLayer, 7> kStandard = {{{0.0, -0.0065},
                                                     {11000.0, 0.0},
                                                     {20000.0, 0.001},
                                                     {32000.0, 0.0028},
                                                     {47000.0, 0.0},
                                                     {51000.0, -0.0028},
                                                     {71000.0, -0.002}}};

double pressure_ratio(double exponent, double lapse_K_m, double temperature_ratio,
                      double above_base_m) {
  return lapse_K_m == 0.0 ? portable::exp(exponent * above_base_m)
                          : portable::exp(exponent * portable::log(temperature_ratio));
}

}  // namespace

Atmosphere::Atmosphere(const AtmosphereParameters& parameters)
    : parameters_{parameters}, layers_{} {
  double temperature = kSeaLevelTemperature_K + parameters.temperature_offset_K;
  double pressure = parameters.sea_level_pressure_Pa;
  for (std::size_t i = 0; i < kLayers; ++i) {
    const auto [base, lapse] = kStandard[i];
    const double slope = lapse == 0.0 ? temperature : lapse;
    const Layer layer{base, lapse, temperature, pressure,
                      -kGravity_m_s2 / (kGasConstant_J_kg_K * slope)};
    layers_[i] = layer;
    if (i + 1 < kLayers) {
      const double thickness = kStandard[i + 1].base_m - base;
      temperature += lapse * thickness;
      pressure *=
          pressure_ratio(layer.exponent, lapse, temperature / layer.temperature_K, thickness);
    }
  }
}

AirProperties Atmosphere::standard(double height_m) const {
  const double geopotential = kEarthRadius_m * height_m / (kEarthRadius_m + height_m);
  std::size_t i = 0;
  while (i + 1 < kLayers && geopotential >= layers_[i + 1].base_m) ++i;
  const Layer& layer = layers_[i];
  const double above = geopotential - layer.base_m;
  // Far above the last layer its lapse would lead to negative temperatures.
  const double temperature = std::max(layer.temperature_K + layer.lapse_K_m * above, 1.0);
  const double pressure =
      layer.pressure_Pa *
      pressure_ratio(layer.exponent, layer.lapse_K_m, temperature / layer.temperature_K, above);
  return {pressure, temperature, pressure / (kGasConstant_J_kg_K * temperature)};
}

AirProperties Atmosphere::at(double height_m) const {
  height_m = height_m > kLowest_m ? std::min(height_m, kHighest_m) : kLowest_m;  // also for a NaN
  if (parameters_.model == AtmosphereModel::kReference) {
    const double base = std::max(1.0 - 2.25694e-5 * height_m, 1e-6);
    const double log_ratio = 5.2553 * portable::log(base);
    return {101325.0 * portable::exp(log_ratio), 300.15,
            1.225 * portable::exp(0.809736894596450 * log_ratio)};
  }
  AirProperties air = standard(height_m);
  if (parameters_.model == AtmosphereModel::kConstant)
    air.density_kg_m3 = parameters_.constant_density_kg_m3;
  return air;
}

}  // namespace rosflight::sim
