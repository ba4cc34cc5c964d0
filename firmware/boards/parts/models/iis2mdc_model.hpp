// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/models/registers.hpp"
#include "firmware/boards/parts/models/truth.hpp"

namespace rosflight::boards::parts::models {

/// ST IIS2MDC: identity, reset and reboot, single measurements with alternating sign of the sensor's
/// offset, status, data, temperature. Four wires are not connected: with the bit for them, reads find
/// nothing.
class Iis2mdcModel final : public SpiRegisters {
 public:
  explicit Iis2mdcModel(MagExposure exposure) : exposure_{std::move(exposure)} { reset(); }

  void advance(Time now) override {
    if (done_ <= now) finish();
    now_ = now;
  }
  Time next_event() const override { return done_; }
  void set_power(bool on) override {
    powered_ = on;
    if (on) reset();
  }

  std::array<double, 3> offset_T{};  ///< Sensor offset; its sign follows the set or reset state.
  bool stalls{false};

 private:
  std::uint8_t read_register(std::uint8_t reg) override {
    if (now_ < ready_) return 0;
    if ((registers[0x62] & 0x04u) != 0) return 0xFF;
    const std::uint8_t value = registers[reg];
    if (reg == 0x6D) registers[0x67] = 0;
    return value;
  }
  void write_register(std::uint8_t reg, std::uint8_t value) override {
    if (reg == 0x60 && (value & 0x60u) != 0) {
      reset();
      ready_ = now_ + ((value & 0x40u) != 0 ? hal::milliseconds(20) : Time{5});
      return;
    }
    if (now_ < ready_) complain("written during the reset");
    if (reg < 0x60 || reg > 0x62) return;
    registers[reg] = value;
    if (reg == 0x60 && (value & 3u) == 1) {
      if (done_ != kNever) complain("commanded during a measurement");
      begun_ = now_;
      done_ = stalls ? kNever : now_ + Time{9400};
    }
  }
  void reset() {
    registers.clear();
    registers[0x4F] = 0x40;
    registers[0x60] = 0x03;
    done_ = kNever;
    ready_ = Time{};
  }
  void finish() {
    const MagTruth truth = exposure_(begun_ + (done_ - begun_) / 2);
    const bool cancels = (registers[0x61] & 0x12u) == 0x12u;
    set_ = cancels ? !set_ : true;
    for (std::size_t k = 0; k < 3; ++k) {
      const double seen = truth.field_T[k] + (set_ ? offset_T[k] : -offset_T[k]);
      put(static_cast<std::uint8_t>(0x68 + 2 * k), to_counts(seen / 1.5e-7));
    }
    put(0x6E, to_counts(8.0 * (truth.temperature_K - 298.15)));
    registers[0x67] = 0x0F;
    registers[0x60] = static_cast<std::uint8_t>(registers[0x60] | 3u);
    done_ = kNever;
  }
  void put(std::uint8_t reg, std::int16_t value) {
    registers[reg] = static_cast<std::uint8_t>(value & 0xFF);
    registers[static_cast<std::uint8_t>(reg + 1)] = static_cast<std::uint8_t>((value >> 8) & 0xFF);
  }

  MagExposure exposure_;
  bool set_{false};
  Time now_{};
  Time begun_{};
  Time done_{kNever};
  Time ready_{};
};

}  // namespace rosflight::boards::parts::models
