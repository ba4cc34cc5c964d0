// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/shared_bus.hpp"
#include "firmware/boards/stm32h7/pins.hpp"

namespace rosflight::boards::stm32h7 {

/// An I2C as master at 100 kHz, byte by byte from its interrupts. RM0433 ch. 47.
///
/// A stop is sent after each transfer, and after an address or byte that nobody acknowledged. abort()
/// frees a bus whose data line a part holds low: up to nine clocks by hand, then a stop (UM10204
/// section 3.1.16). The image forwards event and error interrupts to on_interrupt().
class I2cBus final : public parts::BusHardware {
 public:
  struct Pins {
    Instance i2c;
    unsigned event_irq, error_irq;
    Pin clock, data;
    unsigned function;  ///< Alternate function of both pins.
  };
  /// Longest transfer (72 bytes, 0.09 ms each): what SharedBus is given as its limit.
  static constexpr parts::Time kLimit = hal::milliseconds(8);

  /// The device numbers of transfers are 7-bit addresses.
  explicit I2cBus(const Pins& pins) : pins_{pins} {}

  /// Pins, timing, interrupts. Call it once.
  void open(parts::SharedBus& bus);
  void on_interrupt();

  void begin(std::uint8_t device, const parts::Transfer& transfer) override;
  void abort() override;
  std::uint32_t mask() override;
  void unmask(std::uint32_t state) override;

 private:
  void start_peripheral();
  void address(bool read, std::size_t count, bool stop_at_end);
  void finish(parts::TransferResult result);
  void free_lines();

  Pins pins_;
  parts::SharedBus* bus_{nullptr};
  const parts::Transfer* transfer_{nullptr};
  std::uint8_t device_{0};
  std::size_t moved_{0};  ///< Bytes of the direction under way.
  bool refused_{false};
};

}  // namespace rosflight::boards::stm32h7
