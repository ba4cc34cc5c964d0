// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/pins.hpp"

namespace rosflight::boards::stm32h7::emulator {

// ---- external interrupts

void ExternalInterrupts::reset() {
  Peripheral::reset();
  stuck_ = 0;
}

void ExternalInterrupts::edge(const PinName& pin, bool rising) {
  const std::uint32_t bit = 1U << pin.number;
  if (configuration_.port_of_line(pin.number) != pin.port) return;
  if ((word(rising ? exti::RTSR1 : exti::FTSR1) & bit) == 0) return;
  if ((word(exti::CPUIMR1) & bit) == 0) return;
  word(exti::CPUPR1) |= bit;
  drive_lines();
}

void ExternalInterrupts::stick(unsigned line) {
  stuck_ |= 1U << line;
  word(exti::CPUPR1) |= stuck_;
  drive_lines();
}

void ExternalInterrupts::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  if (offset == exti::CPUPR1) {
    word(offset) = (word(offset) & ~value) | stuck_;
    drive_lines();
    return;
  }
  word(offset) = value;
}

void ExternalInterrupts::drive_lines() {
  constexpr unsigned kOwn = 5;  // lines 0 to 4 have an interrupt each
  constexpr std::uint32_t kNineToFive = 0x03E0U, kFifteenToTen = 0xFC00U;
  const std::uint32_t pending = word(exti::CPUPR1);
  for (unsigned line = 0; line < kOwn; ++line) {
    core().set_line(irq::EXTI0 + line, (pending >> line & 1U) != 0);
  }
  core().set_line(irq::EXTI9_5, (pending & kNineToFive) != 0);
  core().set_line(irq::EXTI15_10, (pending & kFifteenToTen) != 0);
}

// ---- ports

PinPort::PinPort(Core& core, unsigned port, const Instance& instance,
                 ExternalInterrupts& interrupts)
    : Peripheral{core, std::string("GPIO") + static_cast<char>('A' + port), "GPIO", instance},
      port_{port},
      interrupts_{interrupts} {}

void PinPort::reset() {
  std::array<bool, 16> was_low{};
  for (unsigned pin = 0; pin < 16; ++pin) was_low[pin] = is_output(pin) && !level(pin);
  Peripheral::reset();
  word(gpio::MODER) = 0xFFFF'FFFFU;          // analog; the debug pins of ports A and B aside
  for (unsigned pin = 0; pin < 16; ++pin) {  // they float, and the board pulls chip selects up
    if (was_low[pin] && on_output) on_output(pin, true);
  }
}

bool PinPort::level(unsigned pin) const {
  const std::uint32_t source = is_output(pin) ? word(gpio::ODR) : outside_;
  return (source >> pin & 1U) != 0;
}

void PinPort::drive(unsigned pin, bool high) {
  if ((outside_ >> pin & 1U) == static_cast<std::uint32_t>(high)) return;
  outside_ ^= 1U << pin;
  interrupts_.edge({port_, pin}, high);
}

void PinPort::expect_alternate(unsigned pin, unsigned function) const {
  constexpr std::uint32_t kAlternate = 2;
  const std::uint32_t chosen = word(pin < 8 ? gpio::AFR0 : gpio::AFR1) >> (4 * (pin % 8)) & 0xFU;
  if (mode(pin) == kAlternate && chosen == function) return;
  complain("pin " + std::to_string(pin) + " is not given to alternate function " +
           std::to_string(function));
}

void PinPort::expect_open_drain(unsigned pin) const {
  if ((word(gpio::OTYPER) >> pin & 1U) != 0) return;
  complain("pin " + std::to_string(pin) + " drives a shared line high");
}

std::uint32_t PinPort::read(std::uint32_t offset, unsigned /*size*/) {
  if (offset != gpio::IDR) return word(offset);
  std::uint32_t value = 0;
  for (unsigned pin = 0; pin < 16; ++pin) value |= static_cast<std::uint32_t>(level(pin)) << pin;
  return value;
}

void PinPort::write(std::uint32_t offset, std::uint32_t value, unsigned /*size*/) {
  std::uint32_t before = 0, after = 0;
  for (unsigned pin = 0; pin < 16; ++pin)
    before |= static_cast<std::uint32_t>(is_output(pin) && level(pin)) << pin;
  if (offset == gpio::BSRR) {
    word(gpio::ODR) = (word(gpio::ODR) & ~(value >> 16U)) | (value & 0xFFFFU);
  } else {
    word(offset) = value;
  }
  for (unsigned pin = 0; pin < 16; ++pin)
    after |= static_cast<std::uint32_t>(is_output(pin) && level(pin)) << pin;
  if (!on_output) return;
  for (unsigned pin = 0; pin < 16; ++pin) {
    if (((before ^ after) >> pin & 1U) != 0) on_output(pin, (after >> pin & 1U) != 0);
  }
}

}  // namespace rosflight::boards::stm32h7::emulator
