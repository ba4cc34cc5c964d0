// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/battery_monitor.hpp"
#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {

/// Reads two pins with ADC1 ten times per second, and beside them with ADC3 the chip's own temperature sensor and
/// reference: the converter compares with its supply, which the reference measures. 16 bits, 0.8 ms a
/// conversion; each step is taken in a tick, none waits. RM0433 ch. 25.
class BatteryPins {
 public:
  struct Channels {
    std::uint8_t voltage_channel,
        current_channel;  ///< Both of ADC1; their pins are analog after a reset.
  };
  BatteryPins(const Channels& channels, parts::BatteryMonitor& monitor)
      : channels_{channels}, monitor_{monitor} {}

  /// Opens the clock gates and starts the regulators. Once.
  void open();
  /// Bus context, once per tick of 1 ms.
  void step(hal::Time now);
  /// Newest temperature of the chip's junction; 0 before the first. Any context.
  float temperature_K() const { return temperature_K_; }

 private:
  enum class Stage : std::uint8_t { kRegulator, kCalibration, kEnable, kIdle, kVoltage, kCurrent };
  static constexpr unsigned kTicksPerSample = 100;
  static void convert(std::uint8_t channel, std::uint8_t internal_channel);

  Channels channels_;
  parts::BatteryMonitor& monitor_;
  Stage stage_{Stage::kRegulator};
  unsigned ticks_{0};
  hal::Time begun_{};
  std::uint32_t voltage_code_{0}, temperature_code_{0};
  volatile float temperature_K_{0.0f};
};

}  // namespace rosflight::boards::stm32h7
