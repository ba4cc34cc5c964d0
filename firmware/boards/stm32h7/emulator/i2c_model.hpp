// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <vector>

#include "firmware/boards/parts/models/part.hpp"
#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// I2C as master with 7-bit addresses, byte by byte, and the parts on its lines. RM0433 ch. 47.
///
/// Complains of: timing changed while enabled; a start while a transfer runs; data written without
/// room, or read without data; slave modes, DMA, reload and 10-bit addresses, which are not modelled.
class I2cModel final : public Peripheral {
 public:
  I2cModel(Core& core, std::string name, const Instance& instance, const ClockTree& clocks,
           unsigned event_irq, unsigned error_irq);

  void reset() override;
  void event(Ticks now) override;

  /// The part must outlive this.
  void connect(parts::models::I2cPart& part) { parts_.push_back(&part); }
  /// Brings the parts up to date, before the world changes.
  void advance();
  /// Injects a fault: somebody holds the data line low, and nothing moves any more.
  void hold_data_low(bool held) { held_ = held; }
  /// Called when it is enabled: pins can be checked.
  std::function<void()> on_enable;
  std::uint64_t transfers() const { return transfers_; }

 private:
  enum class Phase : std::uint8_t {
    kIdle,
    kAddress,
    kWaitData,
    kSend,
    kReceive,
    kWaitRead,
    kHeld,
    kStop
  };
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void begin();
  void next_byte();
  void end_of_address();
  void end_of_bytes();
  void enter(Phase phase, unsigned bits);
  void raise(const Field& flag) { word(i2c::ISR) |= flag.mask(); }
  Ticks bit_time() const;
  bool enabled() const { return i2c::CR1_PE.of(word(i2c::CR1)) != 0; }
  bool reads() const { return i2c::CR2_RD_WRN.of(word(i2c::CR2)) != 0; }
  void drive_lines();

  const ClockTree& clocks_;
  unsigned event_irq_, error_irq_;
  std::vector<parts::models::I2cPart*> parts_;
  parts::models::I2cPart* selected_{nullptr};
  Phase phase_{Phase::kIdle};
  std::uint32_t left_{0};
  std::uint8_t shifted_{0};
  bool held_{false};
  std::uint64_t transfers_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
