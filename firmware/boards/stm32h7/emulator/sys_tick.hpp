// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/stm32h7/emulator/core.hpp"
#include "firmware/boards/stm32h7/emulator/nvic.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// The timer of the processor itself: 24 bits, counting down. Armv7-M ARM (DDI 0403E) B3.3. Not modelled, and complained
/// of: the clock from outside of the processor.
class SysTick final : public Timed {
 public:
  static constexpr std::uint32_t kControl = 0x10, kReload = 0x14, kValue = 0x18, kEnd = 0x20;
  static constexpr std::uint32_t kEnable = 1U << 0U, kInterrupt = 1U << 1U, kOfProcessor = 1U << 2U,
                                 kWrapped = 1U << 16U;

  SysTick(Core& core, Nvic& nvic) : core_{core}, nvic_{nvic} {}

  void reset();
  /// Length of a cycle of the processor, from now on.
  void set_cycle(Ticks cycle);
  /// @param offset  in the system control space.
  std::uint32_t read(std::uint32_t offset);
  void write(std::uint32_t offset, std::uint32_t value);
  void event(Ticks now) override;

 private:
  bool counts() const { return (control_ & kEnable) != 0 && reload_ > 0; }
  Ticks period() const { return cycle_ * (Ticks{reload_} + 1); }
  std::uint32_t value() const;
  void start_at(std::uint32_t value);
  void schedule();

  Core& core_;
  Nvic& nvic_;
  std::uint32_t control_{0}, reload_{0}, stopped_at_{0};
  Ticks cycle_{2};
  Ticks zero_{0};  ///< When it reaches 0 next.
  bool wrapped_{false};
};

}  // namespace rosflight::boards::stm32h7::emulator
