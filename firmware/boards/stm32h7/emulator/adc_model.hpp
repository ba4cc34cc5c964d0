// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// ADC1 or ADC3: single conversions of 16 bits started by software. RM0433 ch. 25.
///
/// Complains of: a regulator switched on in deep power-down, a calibration without it, an enable without a
/// calibration, a start before ADRDY was read or while it converts, set-up while it converts, a channel that is not preselected, a clock that
/// stands still or is too fast for BOOST; what is not modelled (sequences, triggers, DMA).
class AdcModel final : public Peripheral {
 public:
  static constexpr double kSupply_V =
      3.28;  ///< Supply of the boards, a bit less than the factory's 3.3 V.

  AdcModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks)
      : Peripheral{core, std::move(name), "ADC", instance}, clocks_{clocks} {}

  void reset() override;
  void event(Ticks now) override;
  /// Voltage at a channel's pin; set by the board.
  std::function<double(unsigned channel)> pin_V;

 private:
  static constexpr Ticks kCalibration = 1000 * kTicksPerMicrosecond;
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::uint32_t value);
  void start();
  std::uint64_t clock_Hz() const;
  bool has(const Field& bit) const { return bit.of(word(adc::CR)) != 0; }

  const ClockTree& clocks_;
  bool calibrated_{false}, seen_ready_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
