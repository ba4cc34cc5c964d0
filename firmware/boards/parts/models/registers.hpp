// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <map>

#include "firmware/boards/parts/models/part.hpp"

namespace rosflight::boards::parts::models {

/// Wrong behaviour on request, for a part with registers.
struct Faults {
  bool mute{false};      ///< Does not drive its data line, does not acknowledge.
  bool no_edges{false};  ///< Its data-ready line does not move.
  int lose_writes{0};    ///< So many of the next writes have no effect.
  /// What these registers read instead of their value, such as a wrong identity.
  std::map<std::uint8_t, std::uint8_t> answers;
  /// Bits of these registers that read inverted.
  std::map<std::uint8_t, std::uint8_t> flips;
};

/// 128 registers of 8 bits, and the faults that reads and writes pass through. A part says what its
/// registers do by overriding the two functions.
class RegisterFile {
 public:
  Faults faults;
  std::uint8_t& operator[](std::uint8_t reg) { return values_[reg & 0x7Fu]; }
  std::uint8_t operator[](std::uint8_t reg) const { return values_[reg & 0x7Fu]; }
  void clear() { values_.fill(0); }

  /// What a read of `reg` finds, where the part itself has `value`.
  std::uint8_t seen(std::uint8_t reg, std::uint8_t value) const {
    if (const auto wrong = faults.answers.find(reg); wrong != faults.answers.end()) {
      return wrong->second;
    }
    const auto flip = faults.flips.find(reg);
    return flip == faults.flips.end() ? value : static_cast<std::uint8_t>(value ^ flip->second);
  }
  /// Whether a write arrives.
  bool arrives() {
    if (faults.lose_writes == 0) return true;
    --faults.lose_writes;
    return false;
  }

 private:
  std::array<std::uint8_t, 128> values_{};
};

/// An SPI part with 8-bit registers: the address, whose top bit means reading, then bytes of
/// ascending registers.
class SpiRegisters : public SpiPart {
 public:
  /// @param dummy_bytes  sent by the part before the data.
  explicit SpiRegisters(unsigned dummy_bytes = 0) : dummy_{dummy_bytes} {}

  RegisterFile registers;

  void select(bool selected) override {
    if (selected_ && !selected) deselected();
    selected_ = selected;
    count_ = 0;
  }
  std::uint8_t exchange(std::uint8_t out) override {
    const unsigned k = count_++;
    if (!selected_ || registers.faults.mute || !powered_) return 0xFF;
    if (k == 0) {
      address_ = out;
      return 0;
    }
    if ((address_ & 0x80u) == 0) {
      if (registers.arrives()) write_register(static_cast<std::uint8_t>(address_ + k - 1), out);
      return 0;
    }
    if (k <= dummy_) return 0;
    const auto reg = static_cast<std::uint8_t>((address_ & 0x7Fu) + k - 1 - dummy_);
    return registers.seen(reg, read_register(reg));
  }

 protected:
  virtual std::uint8_t read_register(std::uint8_t reg) { return registers[reg]; }
  virtual void write_register(std::uint8_t reg, std::uint8_t value) { registers[reg] = value; }
  virtual void deselected() {}
  bool powered_{true};

 private:
  unsigned dummy_;
  unsigned count_{0};
  std::uint8_t address_{0};
  bool selected_{false};
};

/// An I2C part with 8-bit registers and a pointer that ascends.
class I2cRegisters : public I2cPart {
 public:
  explicit I2cRegisters(std::uint8_t address) : address_{address} {}

  RegisterFile registers;

  std::uint8_t address() const override { return address_; }
  bool begin(bool read) override {
    pointer_follows_ = !read;
    return powered_ && !registers.faults.mute;
  }
  bool write(std::uint8_t byte) override {
    if (pointer_follows_) {
      pointer_ = byte;
      pointer_follows_ = false;
    } else if (registers.arrives()) {
      write_register(pointer_++, byte);
    }
    return true;
  }
  std::uint8_t read() override {
    const std::uint8_t reg = pointer_++;
    return registers.seen(reg, read_register(reg));
  }
  void stop() override {}

 protected:
  virtual std::uint8_t read_register(std::uint8_t reg) { return registers[reg]; }
  virtual void write_register(std::uint8_t reg, std::uint8_t value) { registers[reg] = value; }
  bool powered_{true};

 private:
  std::uint8_t address_;
  std::uint8_t pointer_{0};
  bool pointer_follows_{false};
};

}  // namespace rosflight::boards::parts::models
