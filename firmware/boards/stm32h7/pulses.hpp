// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>

#include "firmware/boards/parts/pulses.hpp"
#include "firmware/boards/stm32h7/dma_stream.hpp"
#include "firmware/boards/stm32h7/pins.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::stm32h7 {

/// Servo pulses (PWM: 1000 us + 1000 us x value, active high), DShot and plain levels from timers; the arithmetic
/// is in parts/pulses.hpp. RM0433 ch. 38 to 40.
///
/// Channels on one timer are a group with one rate. PWM counts as finely as the period fits 16 bits: 35 ns
/// at 490 Hz. Compare values are preloaded: a change takes effect with the next pulse, and none is cut.
/// DShot: one period is one bit; at each of its ends a DMA burst writes the four compare values of the next,
/// 16 bits and an end of low level. A frame that is on its way when the next is written is not cut; the
/// next is dropped then, which happens only above 1 kHz at the slowest rate.
///
/// A level is the output of a channel that is forced low or high, so neither the counter nor the compare value,
/// which a burst also writes, has an effect on it.
class Pulses final : public hal::Outputs {
 public:
  static constexpr std::size_t kMaxChannels = 10, kMaxGroups = 3, kTimerChannels = 4;
  struct Channel {
    Instance timer;
    std::uint8_t channel;  ///< 0 to 3.
    bool advanced;         ///< The timer needs BDTR.MOE: TIM1 and TIM8.
    Pin pin;
    std::uint8_t function;
  };
  struct Group {
    Instance timer;
    unsigned stream;
    std::uint32_t request;  ///< DMA request of the update of the timer.
  };
  /// Compare values of one group for the DMA, in section .dma.
  using Burst = std::array<std::uint16_t, kTimerChannels * parts::kDshotCounts>;
  struct Memory {
    alignas(32) std::array<Burst, kMaxGroups> bursts;
  };
  struct Pins {
    const Channel* channels;  ///< In the order of the outputs.
    std::size_t count;        ///< <= kMaxChannels.
    std::array<Group, kMaxGroups> groups;
  };

  /// Both must outlive this.
  Pulses(const Pins& pins, Memory& memory) : pins_{pins}, memory_{memory} {}

  /// 0 (a level), 4 to 490 Hz, or 150 000 to 1 200 000 Hz for DShot. @returns false for a rate out of range, or
  /// two rates on one timer: the timer then runs at the slower.
  bool configure(const hal::OutputRates& rates_hz) override;
  void write(const hal::OutputValues& values) override;
  void disable() override;

 private:
  const Channel& channel(std::size_t k) const { return pins_.channels[k]; }
  void start_timer(std::size_t group);
  void write_frames(std::size_t group, const hal::OutputValues& values);
  void set_levels(const hal::OutputValues& values) const;

  const Pins& pins_;
  Memory& memory_;
  std::array<parts::PulsePlan, kMaxGroups> plans_{};
  std::array<std::uint8_t, kMaxChannels> group_of_{};  ///< Group of each channel.
  std::uint16_t levels_{0};                            ///< Bit per channel: it is a level.
  bool enabled_{false};
};

}  // namespace rosflight::boards::stm32h7
