// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>

#include "firmware/boards/stm32h7/pins.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::stm32h7 {

/// Servo pulses (PWM) from timers: 1000 us + 1000 us x value, active high. RM0433 ch. 38 to 40.
///
/// Channels on one timer have one rate. The prescaler is the smallest that fits the period into 16
/// bits, so a pulse resolves to 15 ns x (prescaler + 1): 35 ns at 490 Hz. Compare values are preloaded:
/// a change takes effect with the next pulse, and no pulse is cut. Not there yet: DShot.
class Pulses final : public hal::Outputs {
 public:
  static constexpr std::size_t kMaxChannels = 10;
  struct Channel {
    Instance timer;
    std::uint8_t channel;  ///< 0 to 3.
    bool advanced;         ///< The timer needs BDTR.MOE: TIM1 and TIM8.
    Pin pin;
    std::uint8_t function;
  };

  /// `channels`, `count` <= kMaxChannels of them in the order of the outputs, must outlive this.
  Pulses(const Channel* channels, std::size_t count) : channels_{channels}, count_{count} {}

  /// 0 (off) to 490 Hz. @returns false for DShot, a rate out of range, or two rates on one timer: the
  /// timer then runs at the slower.
  bool configure(const hal::OutputRates& rates_hz) override;
  void write(const hal::OutputValues& values) override;
  void disable() override;

 private:
  void start_timer(std::size_t first, float rate_hz);
  void set_compare(std::size_t index, std::uint32_t ticks);

  const Channel* channels_;
  std::size_t count_;
  std::array<float, kMaxChannels> ticks_per_us_{};  ///< 0: the channel is off.
  bool enabled_{false};
};

}  // namespace rosflight::boards::stm32h7
