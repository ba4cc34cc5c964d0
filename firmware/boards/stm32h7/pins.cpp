// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/pins.hpp"

#include "firmware/boards/stm32h7/clocks.hpp"

namespace rosflight::boards::stm32h7 {
namespace {

constexpr Instance kPorts[] = {GPIOA, GPIOB, GPIOC, GPIOD, GPIOE, GPIOF,
                               GPIOG, GPIOH, GPIOI, GPIOJ, GPIOK};
constexpr std::uint32_t kInput = 0, kOutput = 1, kAlternate = 2, kFast = 2;

const Instance& port_of(const Pin& pin) {
  return kPorts[pin.port_index()];
}

/// The pin's bits in a register with `width` bits a pin.
Field field(const Pin& pin, std::uint32_t width) {
  return {pin.number * width, width};
}

}  // namespace

void open_ports() {
  for (const Instance& port : kPorts) open_gate(port);
  open_gate(SYSCFG);
  volatile std::uint32_t& switches = reg(SYSCFG, syscfg::PMCR);
  switches = switches & ~(syscfg::PMCR_PC2SO.mask() | syscfg::PMCR_PC3SO.mask());
}

void make_output(const Pin& pin, bool high, Drive drive) {
  const Instance& port = port_of(pin);
  set_level(pin, high);
  modify(reg(port, gpio::OTYPER), field(pin, 1), static_cast<std::uint32_t>(drive));
  modify(reg(port, gpio::MODER), field(pin, 2), kOutput);
}

void make_input(const Pin& pin, Pull pull) {
  const Instance& port = port_of(pin);
  modify(reg(port, gpio::PUPDR), field(pin, 2), static_cast<std::uint32_t>(pull));
  modify(reg(port, gpio::MODER), field(pin, 2), kInput);
}

void make_alternate(const Pin& pin, unsigned function, Pull pull) {
  const Instance& port = port_of(pin);
  const Field which{pin.number % 8u * 4u, 4};
  modify(reg(port, pin.number < 8 ? gpio::AFR0 : gpio::AFR1), which, function);
  modify(reg(port, gpio::OSPEEDR), field(pin, 2), kFast);
  modify(reg(port, gpio::PUPDR), field(pin, 2), static_cast<std::uint32_t>(pull));
  modify(reg(port, gpio::MODER), field(pin, 2), kAlternate);
}

bool level(const Pin& pin) {
  return (reg(port_of(pin), gpio::IDR) >> pin.number & 1u) != 0;
}

void set_level(const Pin& pin, bool high) {
  reg(port_of(pin), gpio::BSRR) = 1u << (pin.number + (high ? 0u : 16u));
}

void watch_rising_edge(const Pin& pin) {
  open_gate(SYSCFG);
  const std::uint32_t line = pin.number;
  const Field port{line % 4u * 4u, 4};
  modify(reg(SYSCFG, syscfg::EXTICR1 + 4u * (line / 4u)), port, pin.port_index());
  modify(reg(EXTI, exti::RTSR1), {line, 1}, 1);
  clear_edge(pin);
  modify(reg(EXTI, exti::CPUIMR1), {line, 1}, 1);
}

}  // namespace rosflight::boards::stm32h7
