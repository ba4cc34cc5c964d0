// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>

#include "firmware/boards/stm32h7/emulator/peripheral.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// A pin by port (0 is A) and number.
struct PinName {
  unsigned port{};
  unsigned number{};
};

/// System configuration: which port an external interrupt line belongs to.
class SystemConfiguration final : public Peripheral {
 public:
  explicit SystemConfiguration(Core& core) : Peripheral{core, "SYSCFG", "SYSCFG", SYSCFG} {}
  void reset() override {
    Peripheral::reset();
    word(syscfg::PMCR) = syscfg::PMCR_PC2SO(1) | syscfg::PMCR_PC3SO(1);
  }
  /// The pads PC2_C and PC3_C are connected with PC2 and PC3.
  bool pads_of_port_c_connected() const {
    return (word(syscfg::PMCR) & (syscfg::PMCR_PC2SO.mask() | syscfg::PMCR_PC3SO.mask())) == 0;
  }
  unsigned port_of_line(unsigned line) const {
    return word(syscfg::EXTICR1 + 4 * (line / 4)) >> (4 * (line % 4)) & 0xFU;
  }
};

/// External interrupts of pins. RM0433 ch. 20.
class ExternalInterrupts final : public Peripheral {
 public:
  ExternalInterrupts(Core& core, const SystemConfiguration& configuration)
      : Peripheral{core, "EXTI", "EXTI", EXTI}, configuration_{configuration} {}
  void edge(const PinName& pin, bool rising);
  /// Injects a fault: the line's interrupt stays pending whatever the firmware clears.
  void stick(unsigned line);
  void reset() override;

 private:
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void drive_lines();

  const SystemConfiguration& configuration_;
  std::uint32_t stuck_{0};
};

/// One port of 16 pins.
class PinPort final : public Peripheral {
 public:
  PinPort(Core& core, unsigned port, const Instance& instance, ExternalInterrupts& interrupts);
  void reset() override;

  /// Drives a pin from outside.
  void drive(unsigned pin, bool high);
  /// Level on the pad, from the chip or from outside.
  bool level(unsigned pin) const;
  bool is_output(unsigned pin) const { return mode(pin) == 1; }
  /// Complains unless the pin is given to this alternate function.
  void expect_alternate(unsigned pin, unsigned function) const;
  /// Complains unless the pin can only be pulled low.
  void expect_open_drain(unsigned pin) const;
  std::function<void(unsigned pin, bool high)> on_output;

 private:
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  std::uint32_t mode(unsigned pin) const { return word(gpio::MODER) >> (2 * pin) & 3U; }

  unsigned port_;
  ExternalInterrupts& interrupts_;
  std::uint32_t outside_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
