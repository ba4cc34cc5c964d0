// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "firmware/boards/stm32h7/emulator/flash_control.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// Supply and core voltage. RM0433 ch. 6: the supply is chosen once after power-on.
class PowerControl final : public Peripheral {
 public:
  explicit PowerControl(Core& core) : Peripheral{core, "PWR", "PWR", PWR} {}
  void reset() override;
  /// Scale 1 (highest without overdrive) was asked for, with the supply chosen before.
  bool scale_1() const { return supplied_ && pwr::D3CR_VOS.of(word(pwr::D3CR)) == 3; }
  bool usb_supplied() const { return pwr::CR3_USB33DEN.of(word(pwr::CR3)) != 0; }
  /// Backup memory may be written.
  bool backup_open() const { return pwr::CR1_DBP.of(word(pwr::CR1)) != 0; }

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  bool supplied_{false}, seen_ready_{false};
};

/// Oscillators, PLLs, dividers, clock gates, resets and reset flags. RM0433 ch. 8.
///
/// Complains of a PLL out of its range, of a change while it runs, of a system clock too fast for the
/// wait states or the voltage, and of a PLL that does not run yet.
class ClockTree final : public Peripheral {
 public:
  /// @param crystal_Hz  what the board has at HSE.
  ClockTree(Core& core, std::uint64_t crystal_Hz, const FlashControl& flash,
            const PowerControl& power);

  void reset() override;
  bool gate_open(const Instance& instance);
  std::uint64_t core_Hz() const { return core_Hz_; }
  /// Clock of APB peripherals; all four domains are alike unless the firmware divides otherwise.
  std::uint64_t apb_Hz() const { return apb_Hz_; }
  /// One count of a timer without prescaler.
  Ticks timer_period() const { return timer_period_; }
  /// Output 'P', 'Q' or 'R' of PLL 1, 2 or 3; 0 if it does not run.
  std::uint64_t pll_Hz(unsigned pll, char output) const;
  /// Kernel clock of the USB; 0 if it is not PLL3's.
  std::uint64_t usb_Hz() const;
  /// Kernel clock of the converters; 0 if it is not PLL3's.
  std::uint64_t adc_Hz() const;
  /// Kernel clock of an SPI.
  std::uint64_t spi_Hz(const Instance& spi) const;

  /// What RSR shows after the coming reset.
  void set_reset_cause(const Field& cause) { reset_flags_ |= cause.mask(); }
  void set_power_on();
  std::function<void(std::uint64_t core_Hz)> on_core_clock;
  /// The firmware wrote a reset bit: pulses it.
  std::function<void(std::uint32_t offset, std::uint32_t bits)> on_peripheral_reset;

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void look_at_dividers();
  void check_pll(unsigned pll) const;
  void check_switch() const;
  std::uint64_t reference_Hz(unsigned pll) const;
  std::uint64_t vco_Hz(unsigned pll) const;
  bool runs(unsigned pll) const;

  std::uint64_t crystal_Hz_;
  const FlashControl& flash_;
  const PowerControl& power_;
  std::uint32_t reset_flags_{};
  std::uint64_t core_Hz_{}, apb_Hz_{};
  Ticks timer_period_{};
  std::array<std::uint32_t, 64> unread_{};  ///< Gates opened since the register was last read.
};

/// Independent watchdog. RM0433 ch. 45: runs on LSI (32 kHz) and resets the chip.
class WatchdogModel final : public Peripheral {
 public:
  WatchdogModel(Core& core, ClockTree& clocks)
      : Peripheral{core, "IWDG1", "IWDG", IWDG1}, clocks_{clocks} {}
  void reset() override;
  void event(Ticks now) override;
  std::function<void()> on_bite;
  std::function<void()> on_start;

 private:
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  ClockTree& clocks_;
  bool running_{false}, unlocked_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
