// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/handover.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// What the factory measured of a converter's references, at 3.3 V and 16 bits.
struct AdcCalibration {
  float reference_code{};         ///< Code of the internal reference.
  float low_code{}, high_code{};  ///< Codes of the temperature sensor ...
  static constexpr float kLow_degC = 30.0f, kHigh_degC = 110.0f;  ///< ... at these temperatures.
};

/// From the code of a pin to what is behind it: value = (volts at the pin - offset) * scale.
struct AdcScale {
  float scale{1.0f};
  float offset_V{0.0f};
};

/// Supply of the converter from the code of its internal reference [V]; 0 if that code is 0.
float adc_supply_V(const AdcCalibration& calibration, std::uint32_t reference_code);
/// Voltage at a pin, of 16 bits.
float adc_pin_V(std::uint32_t code, float supply_V);
/// Temperature of the chip [K]; 0 if the calibration words are blank.
float chip_temperature_K(const AdcCalibration& calibration, std::uint32_t code, float supply_V);

/// Battery voltage and current of a board, from the converter to the main loop. What set_multipliers()
/// sets replaces the board's scale; 0 keeps the one in force. An offset always belongs to the board.
class BatteryMonitor final : public hal::Battery {
 public:
  BatteryMonitor(const AdcScale& voltage, const AdcScale& current)
      : board_voltage_{voltage},
        board_current_{current},
        voltage_{voltage.scale},
        current_{current.scale} {}

  /// Bus context: voltages at the two pins, measured at `stamp`.
  void measured(hal::Time stamp, float voltage_pin_V, float current_pin_V);
  /// Main loop.
  bool poll(hal::BatterySample& sample) override;
  void set_multipliers(float voltage, float current) override;

 private:
  AdcScale board_voltage_;
  AdcScale board_current_;
  float voltage_;
  float current_;
  Handover<hal::BatterySample, 2> pins_;  ///< Volts at the pins.
};

}  // namespace rosflight::boards::parts
