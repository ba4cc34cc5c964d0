// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/bus.hpp"
#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {

/// A pin by port letter and number, as on a schematic.
struct Pin {
  char port;
  std::uint8_t number;

  constexpr unsigned port_index() const { return static_cast<unsigned>(port - 'A'); }
};

enum class Pull : std::uint8_t { kNone = 0, kUp = 1, kDown = 2 };
enum class Drive : std::uint8_t { kPushPull = 0, kOpenDrain = 1 };

/// Opens the clock gates of all ports, and connects the pads PC2_C and PC3_C with PC2 and PC3.
void open_ports();
/// The level is set before the pin becomes an output.
void make_output(const Pin& pin, bool high, Drive drive = Drive::kPushPull);
void make_input(const Pin& pin, Pull pull = Pull::kNone);
/// Gives the pin to a peripheral; speed is "high" (up to 100 MHz).
void make_alternate(const Pin& pin, unsigned function, Pull pull = Pull::kNone);
bool level(const Pin& pin);
/// One atomic write.
void set_level(const Pin& pin, bool high);

/// An output pin that a part driver moves; make_output() is the board's.
class DrivenPin final : public parts::OutputPin {
 public:
  explicit DrivenPin(const Pin& pin) : pin_{pin} {}
  void set(bool high) override { set_level(pin_, high); }

 private:
  Pin pin_;
};

/// External interrupt on the rising edge of an input pin; the line number is the pin's number, so two
/// pins with one number exclude each other.
void watch_rising_edge(const Pin& pin);
inline bool edge_pending(const Pin& pin) {
  return (reg(EXTI, exti::CPUPR1) >> pin.number & 1u) != 0;
}
inline void clear_edge(const Pin& pin) {
  reg(EXTI, exti::CPUPR1) = 1u << pin.number;
  const std::uint32_t back = reg(EXTI, exti::CPUPR1);
  static_cast<void>(back);  // the write has arrived: the interrupt does not come again
}

}  // namespace rosflight::boards::stm32h7
