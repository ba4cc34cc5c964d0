// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/sampling.hpp"

namespace rosflight::sim::sensors {

/// Voltage and current at the battery's terminals, each through its own converter.
class BatteryMonitor {
 public:
  using Sample = hal::BatterySample;

  struct Config {
    Timing timing;
    ErrorParameters voltage_V;
    ErrorParameters current_A;
    double fixed_voltage_V{};  ///< Above 0: used instead of the truth, as in ROSflight 2.x.
    double fixed_current_A{};  ///< The same; used if fixed_voltage_V is.
  };

  /// @param source  of the random errors.
  BatteryMonitor(const Config& config, const RandomSource& source)
      : config_{config},
        voltage_{config.voltage_V, config.timing.period, source, "sensors/battery/voltage"},
        current_{config.current_A, config.timing.period, source, "sensors/battery/current"} {}

  /// Voltage and current with their errors.
  bool measure(const Truth& truth, Sample& sample) {
    const bool fixed = config_.fixed_voltage_V > 0.0;
    const double voltage_V = fixed ? config_.fixed_voltage_V : truth.battery_voltage_V;
    const double current_A = fixed ? config_.fixed_current_A : truth.battery_current_A;
    sample = {.stamp = truth.time,
              .voltage_V = static_cast<float>(voltage_.apply(voltage_V)),
              .current_A = static_cast<float>(current_.apply(current_A))};
    return true;
  }

 private:
  Config config_;
  ErrorModel voltage_;
  ErrorModel current_;
};

}  // namespace rosflight::sim::sensors
