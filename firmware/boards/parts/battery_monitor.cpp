// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/battery_monitor.hpp"

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr float kCalibratedAt_V = 3.3f;
constexpr float kFullScale = 65535.0f;

}  // namespace

float adc_supply_V(const AdcCalibration& calibration, std::uint32_t reference_code) {
  if (reference_code == 0) return 0.0f;
  return kCalibratedAt_V * calibration.reference_code / static_cast<float>(reference_code);
}

float adc_pin_V(std::uint32_t code, float supply_V) {
  return static_cast<float>(code) / kFullScale * supply_V;
}

float chip_temperature_K(const AdcCalibration& c, std::uint32_t code, float supply_V) {
  const float span = c.high_code - c.low_code;
  if (!(span > 0.0f)) return 0.0f;
  const float as_calibrated = static_cast<float>(code) * supply_V / kCalibratedAt_V;
  return kZeroCelsius_K + c.kLow_degC +
         (c.kHigh_degC - c.kLow_degC) * (as_calibrated - c.low_code) / span;
}

void BatteryMonitor::measured(hal::Time stamp, float voltage_pin_V, float current_pin_V) {
  static_cast<void>(pins_.put({stamp, voltage_pin_V, current_pin_V}));
}

bool BatteryMonitor::poll(hal::BatterySample& sample) {
  hal::BatterySample pins;
  if (!pins_.take(pins)) return false;
  sample.stamp = pins.stamp;
  sample.voltage_V = (pins.voltage_V - board_voltage_.offset_V) * voltage_;
  sample.current_A = (pins.current_A - board_current_.offset_V) * current_;
  return true;
}

void BatteryMonitor::set_multipliers(float voltage, float current) {
  if (voltage != 0.0f) voltage_ = voltage;
  if (current != 0.0f) current_ = current;
}

}  // namespace rosflight::boards::parts
