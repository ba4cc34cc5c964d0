// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// A timer that counts up: update interrupt and pulses on four channels. RM0433 ch. 38 to 41.
///
/// Prescaler, and with preload also period and compare values, take effect at an update. Not
/// modelled, and complained of: other counting directions, capture, slave modes, DMA requests.
class TimerModel final : public Peripheral {
 public:
  static constexpr std::size_t kChannels = 4;
  enum class Kind : std::uint8_t { kPlain, kWide, kAdvanced };  ///< Wide: 32 bits. Advanced: BDTR.

  TimerModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
             unsigned irq, Kind kind);

  void reset() override;
  void event(Ticks now) override;

  /// Width of the pulses on a channel's pin now [ticks of the guest]; 0: the pin is still.
  Ticks pulse(std::size_t channel) const;
  /// Time of the last write to this channel's compare register.
  Ticks written(std::size_t channel) const { return written_[channel]; }
  Ticks period() const { return tick() * (std::uint64_t{active_reload_} + 1); }
  /// When the counter was started, as if it had counted from 0.
  Ticks zero() const { return zero_; }
  /// Called after each change of its registers by the firmware, and after a reset.
  std::function<void()> on_change;
  bool counts() const { return tim::CR1_CEN.of(word(tim::CR1)) != 0; }

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::uint32_t value);
  Ticks tick() const { return clocks_.timer_period() * (Ticks{active_prescaler_} + 1); }
  std::uint32_t count() const;
  void update(bool by_software);
  void schedule();
  void drive_line();
  bool preloads(std::size_t channel) const;
  std::uint32_t mode(std::size_t channel) const;

  const ClockTree& clocks_;
  unsigned irq_;
  Kind kind_;
  Ticks zero_{0};
  std::uint32_t active_prescaler_{0}, active_reload_{0}, stopped_at_{0};
  std::array<std::uint32_t, kChannels> active_compare_{};
  std::array<Ticks, kChannels> written_{};
};

}  // namespace rosflight::boards::stm32h7::emulator
