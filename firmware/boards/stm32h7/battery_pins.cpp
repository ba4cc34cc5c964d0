// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/battery_pins.hpp"

#include "firmware/boards/stm32h7/clocks.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr Instance kConverters[] = {ADC1, ADC3};
constexpr std::uint8_t kTemperatureChannel = 18, kReferenceChannel = 19;    // of ADC3
constexpr std::uint32_t kInternal = adc::CCR_TSEN(1) | adc::CCR_VREFEN(1);  // switches both on
constexpr std::uint32_t kDivideBy32 = 8;     // 64 MHz to 2 MHz; the converter halves it again
constexpr std::uint32_t kMaxSampleTime = 7;  // 810.5 cycles
constexpr std::uintptr_t kReferenceCalibration = 0x1FF1'E860u;
constexpr std::uintptr_t kLowTemperature = 0x1FF1'E820u, kHighTemperature = 0x1FF1'E840u;

/// A code that the factory measured.
float factory_code(std::uintptr_t address) {
  return static_cast<float>(memory_at<const volatile std::uint16_t>(address));
}

/// A whole write: the bits of CR that start something are set by writing 1 and stay otherwise.
constexpr std::uint32_t kRegulatorOn = adc::CR_ADVREGEN(1);

bool all(std::uint32_t offset, const Field& field, std::uint32_t value) {
  for (const Instance& each : kConverters) {
    if (field.of(reg(each, offset)) != value) return false;
  }
  return true;
}

void command(std::uint32_t bits) {
  for (const Instance& each : kConverters) reg(each, adc::CR) = kRegulatorOn | bits;
}

}  // namespace

void BatteryPins::open() {
  for (const Instance& each : kConverters) {
    open_gate(each);
    reg(each, adc::CR) = 0;  // out of deep power-down first
    reg(each, adc::CCR) = adc::CCR_PRESC(kDivideBy32) | (each == ADC3 ? kInternal : 0);
    reg(each, adc::CR) = kRegulatorOn;  // up within 10 us: long before the next tick
  }
}

/// Starts one conversion of both converters.
void BatteryPins::convert(std::uint8_t channel, std::uint8_t internal_channel) {
  for (const Instance& each : kConverters) {
    const std::uint8_t which = each == ADC3 ? internal_channel : channel;
    const std::uint32_t in_register = which % 10u * 3u;
    reg(each, adc::PCSEL) = 1u << which;
    reg(each, which < 10 ? adc::SMPR1 : adc::SMPR2) = kMaxSampleTime << in_register;
    reg(each, adc::SQR1) = adc::SQR1_SQ1(which);
    reg(each, adc::CR) = kRegulatorOn | adc::CR_ADEN(1) | adc::CR_ADSTART(1);
  }
}

void BatteryPins::step(hal::Time now) {
  ++ticks_;
  switch (stage_) {
    case Stage::kRegulator:
      command(adc::CR_ADCAL(1));
      stage_ = Stage::kCalibration;
      break;
    case Stage::kCalibration:
      if (!all(adc::CR, adc::CR_ADCAL, 0)) return;
      command(adc::CR_ADEN(1));
      stage_ = Stage::kEnable;
      break;
    case Stage::kEnable:
      if (all(adc::ISR, adc::ISR_ADRDY, 1)) stage_ = Stage::kIdle;
      break;
    case Stage::kIdle:
      if (ticks_ % kTicksPerSample != 0) return;
      begun_ = now;
      convert(channels_.voltage_channel, kTemperatureChannel);
      stage_ = Stage::kVoltage;
      break;
    case Stage::kVoltage:
      if (!all(adc::ISR, adc::ISR_EOC, 1)) return;
      voltage_code_ = reg(ADC1, adc::DR);
      temperature_code_ = reg(ADC3, adc::DR);
      convert(channels_.current_channel, kReferenceChannel);
      stage_ = Stage::kCurrent;
      break;
    case Stage::kCurrent: {
      if (!all(adc::ISR, adc::ISR_EOC, 1)) return;
      parts::AdcCalibration calibration;
      calibration.reference_code = factory_code(kReferenceCalibration);
      calibration.low_code = factory_code(kLowTemperature);
      calibration.high_code = factory_code(kHighTemperature);
      const std::uint32_t current_code = reg(ADC1, adc::DR);
      const float supply_V = parts::adc_supply_V(calibration, reg(ADC3, adc::DR));
      monitor_.measured(begun_ + (now - begun_) / 2, parts::adc_pin_V(voltage_code_, supply_V),
                        parts::adc_pin_V(current_code, supply_V));
      temperature_K_ = parts::chip_temperature_K(calibration, temperature_code_, supply_V);
      stage_ = Stage::kIdle;
      break;
    }
  }
}

}  // namespace rosflight::boards::stm32h7
