// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/models/part.hpp"

namespace rosflight::boards::parts::models {

/// FM25V02A: identity, write-enable latch that each write clears, status, reading and writing of 32 KiB.
/// Contents survive the power.
class FramModel final : public SpiPart {
 public:
  void advance(Time /*now*/) override {}
  Time next_event() const override { return kNever; }
  void set_power(bool on) override {
    powered_ = on;
    latch_ = false;
  }
  void select(bool selected) override {
    if (!selected && selected_ && command_ == 0x02 && count_ > 3) latch_ = false;
    if (!selected && selected_ && command_ == 0x06) latch_ = true;
    if (selected && !selected_) ++transfers;
    selected_ = selected;
    count_ = 0;
    command_ = 0;
  }
  std::uint8_t exchange(std::uint8_t out) override {
    const std::size_t k = count_++;
    if (mute || !powered_) return 0xFF;
    if (k == 0) {
      command_ = out;
      return 0;
    }
    if (command_ == 0x9F) return k <= identity.size() ? identity[k - 1] : std::uint8_t{0};
    if (command_ == 0x05) return latch_ ? 2 : 0;
    if (command_ != 0x02 && command_ != 0x03) return 0;
    if (k <= 2) {
      address_ = (address_ << 8 | out) & 0x7FFFu;
      return 0;
    }
    std::uint8_t& cell = cells[address_];
    address_ = (address_ + 1) & 0x7FFFu;
    if (command_ == 0x03) return cell;
    if (!latch_) {
      complain("written without permission");
    } else {
      cell = out;
    }
    return 0;
  }

  std::array<std::uint8_t, 32768> cells{};
  std::array<std::uint8_t, 9> identity{0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0xC2, 0x22, 0x08};
  bool mute{false};
  int transfers{0};

 private:
  bool powered_{true};
  bool selected_{false};
  bool latch_{false};
  std::uint8_t command_{0};
  std::size_t count_{0};
  unsigned address_{0};
};

/// MCP4017: one byte, the wiper, which comes up in the middle.
class Mcp4017Model final : public I2cPart {
 public:
  std::uint8_t address() const override { return 0x2F; }
  void advance(Time /*now*/) override {}
  Time next_event() const override { return kNever; }
  void set_power(bool on) override {
    mute = !on;
    wiper = 0x3F;
  }
  bool begin(bool /*read*/) override { return !mute; }
  bool write(std::uint8_t byte) override {
    if (!stuck) wiper = byte & 0x7Fu;
    ++writes;
    return true;
  }
  std::uint8_t read() override { return wiper; }
  void stop() override {}

  std::uint8_t wiper{0x3F};
  int writes{0};
  bool mute{false};
  bool stuck{false};
};

}  // namespace rosflight::boards::parts::models
