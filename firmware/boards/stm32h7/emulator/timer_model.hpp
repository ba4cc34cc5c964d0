// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// A timer that counts up: update interrupt, pulses or forced levels on four channels, bursts by DMA at each update, and
/// the DShot frames that these make. RM0433 ch. 38 to 41.
///
/// Prescaler, and with preload also period and compare values, take effect at an update. Not
/// modelled, and complained of: other counting directions, capture, slave modes, other DMA requests; a DShot
/// train that is no frame, or whose checksum is wrong.
class TimerModel final : public Peripheral {
 public:
  static constexpr std::size_t kChannels = 4;
  enum class Kind : std::uint8_t { kPlain, kWide, kAdvanced };  ///< Wide: 32 bits. Advanced: BDTR.

  TimerModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
             unsigned irq, Kind kind, const DmaRequests* dma = nullptr,
             std::uint32_t update_request = 0);

  void reset() override;
  void event(Ticks now) override;

  /// Width of the pulses on a channel's pin now [ticks of the guest]; 0: the pin is still.
  Ticks pulse(std::size_t channel) const;
  /// The channel's output is forced, so its pin is a level.
  bool forces(std::size_t channel) const;
  /// The level that is forced on a channel's pin.
  bool forced_high(std::size_t channel) const;
  /// It makes bits, not pulses: its bursts are on.
  bool makes_dshot() const { return tim::DIER_UDE.of(word(tim::DIER)) != 0; }
  static constexpr std::size_t kDshotBits = 16;
  /// Throttle of the last DShot frame on a channel's pin, 0 to 2047.
  std::uint32_t dshot_throttle(std::size_t channel) const { return throttle_[channel]; }
  /// High time of each bit of that frame [counts].
  const std::array<std::uint32_t, kDshotBits>& dshot_high(std::size_t channel) const {
    return high_[channel];
  }
  /// Good frames since the reset.
  std::uint32_t dshot_frames(std::size_t channel) const { return frames_[channel]; }
  /// The controller started a stream for this request.
  void stream_started(std::uint32_t request) {
    if (request == update_request_) schedule();
  }
  /// Time of the last write to this channel's compare register.
  Ticks written(std::size_t channel) const { return written_[channel]; }
  /// One count.
  Ticks tick() const { return clocks_.timer_period() * (Ticks{active_prescaler_} + 1); }
  Ticks period() const { return tick() * (std::uint64_t{active_reload_} + 1); }
  /// When the counter was started, as if it had counted from 0.
  Ticks zero() const { return zero_; }
  /// Called when the counter is started.
  std::function<void()> on_start;
  /// Called after each change of its registers by the firmware, and after a reset.
  std::function<void()> on_change;
  bool counts() const { return tim::CR1_CEN.of(word(tim::CR1)) != 0; }

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void write_control(std::uint32_t value);
  std::uint32_t count() const;
  void update(bool by_software);
  void burst();
  void note_bit();
  void take_frame(std::size_t channel);
  void schedule();
  void drive_line();
  bool preloads(std::size_t channel) const;
  bool drives(std::size_t channel) const;
  std::uint32_t mode(std::size_t channel) const;

  const ClockTree& clocks_;
  unsigned irq_;
  Kind kind_;
  const DmaRequests* dma_;
  std::uint32_t update_request_;
  std::array<std::vector<std::uint32_t>, kChannels> train_;  ///< Pulses since the last low period.
  std::array<std::uint32_t, kChannels> throttle_{}, frames_{};
  std::array<std::array<std::uint32_t, kDshotBits>, kChannels> high_{};
  Ticks zero_{0};
  std::uint32_t active_prescaler_{0}, active_reload_{0}, stopped_at_{0};
  std::array<std::uint32_t, kChannels> active_compare_{};
  std::array<Ticks, kChannels> written_{};
};

}  // namespace rosflight::boards::stm32h7::emulator
