// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

/// The emulated STM32H7: a processor (Unicorn Engine executes the instructions) and models of the
/// chip's peripherals and of what is soldered to it.
namespace rosflight::boards::stm32h7::emulator {

/// Time of the guest in units of 1.25 ns: half a cycle of a 400 MHz core.
using Ticks = std::uint64_t;
inline constexpr std::uint64_t kTicksPerSecond = 800'000'000;
inline constexpr Ticks kTicksPerMicrosecond = kTicksPerSecond / 1'000'000;
inline constexpr Ticks kNever = ~Ticks{0};

/// Length of one period, rounded to the nearest tick.
constexpr Ticks period_of(std::uint64_t frequency_Hz) {
  return frequency_Hz == 0 ? kNever : (kTicksPerSecond + frequency_Hz / 2) / frequency_Hz;
}

/// Something that acts at a time of its own choice.
class Timed {
 public:
  virtual ~Timed() = default;
  /// Its time has come; `due` is kNever again.
  virtual void event(Ticks now) = 0;
  Ticks due{kNever};
};

/// What a model may ask of the processor it is connected to. Tests of models implement it without
/// a processor.
class Core {
 public:
  virtual ~Core() = default;
  virtual Ticks now() const = 0;
  /// Calls `timed.event()` at this time; kNever cancels.
  virtual void set_due(Timed& timed, Ticks time) = 0;
  /// Level of an interrupt request line.
  virtual void set_line(unsigned irq, bool high) = 0;
  /// Memory behind an address of the guest, or nullptr if there is none.
  virtual std::uint8_t* memory(std::uint32_t address, std::size_t count) = 0;
  /// Whether the data cache may hold a copy of this address.
  virtual bool cacheable(std::uint32_t address) const = 0;
  /// Resets the chip at the end of the instruction under way.
  virtual void request_reset() = 0;
  /// The next instruction takes an imprecise bus fault.
  virtual void bus_error() = 0;
  /// The firmware did what silicon would answer with misbehaviour. One line.
  virtual void complain(const std::string& what) = 0;
};

}  // namespace rosflight::boards::stm32h7::emulator
