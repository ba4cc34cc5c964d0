// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/models/registers.hpp"
#include "firmware/boards/parts/models/truth.hpp"

namespace rosflight::boards::parts::models {

/// Isentek IST8308: identity, reset bit that clears itself, range, averaging, single measurements,
/// ready and overrun bits, data.
class Ist8308Model final : public I2cRegisters {
 public:
  explicit Ist8308Model(MagExposure exposure) : I2cRegisters{0x0C}, exposure_{std::move(exposure)} {
    reset();
  }

  void advance(Time now) override {
    if (done_ <= now) finish();
    if (resets_until_ <= now) registers[0x32] = 0;
    now_ = now;
  }
  Time next_event() const override { return done_; }
  void set_power(bool on) override {
    powered_ = on;
    if (on) reset();
  }

  Time reset_time{hal::milliseconds(20)};
  bool stalls{false};  ///< Measurements never end.

 private:
  std::uint8_t read_register(std::uint8_t reg) override {
    const std::uint8_t value = registers[reg];
    if (reg == 0x16) registers[0x10] = 0;
    return value;
  }
  void write_register(std::uint8_t reg, std::uint8_t value) override {
    if (reg == 0x32 && (value & 1u) != 0) {
      reset();
      registers[0x32] = 1;
      resets_until_ = now_ + reset_time;
      return;
    }
    if (now_ < resets_until_) complain("written during the reset");
    registers[reg] = value;
    if (reg == 0x31 && value == 0x01) {
      if (done_ != kNever) complain("commanded during a measurement");
      begun_ = now_;
      // 16 times: 8 ms; 2 ms without averaging.
      done_ =
          stalls ? kNever : now_ + ((registers[0x41] & 0x3Fu) == 0x24 ? Time{8000} : Time{2000});
    }
  }
  void reset() {
    registers.clear();
    registers[0x00] = 0x08;
    done_ = kNever;
    resets_until_ = Time{};
  }
  void finish() {
    const MagTruth truth = exposure_(begun_ + (done_ - begun_) / 2);
    const double lsb_per_T = (registers[0x34] & 1u) != 0 ? 13.2e6 : 6.6e6;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto raw = static_cast<std::uint16_t>(to_counts(truth.field_T[k] * lsb_per_T));
      registers[static_cast<std::uint8_t>(0x11 + 2 * k)] = static_cast<std::uint8_t>(raw & 0xFFu);
      registers[static_cast<std::uint8_t>(0x12 + 2 * k)] = static_cast<std::uint8_t>(raw >> 8);
    }
    registers[0x10] = (registers[0x10] & 1u) != 0 ? 3 : 1;
    registers[0x31] = 0;
    done_ = kNever;
  }

  MagExposure exposure_;
  Time now_{};
  Time begun_{};
  Time done_{kNever};
  Time resets_until_{};
};

}  // namespace rosflight::boards::parts::models
