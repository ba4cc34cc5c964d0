// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/models/part.hpp"
#include "firmware/boards/parts/models/truth.hpp"

namespace rosflight::boards::parts::models {

/// TE MS4525DO: four bytes per read; a reading that comes before the measurement of 0.5 ms has ended
/// is stale.
class Ms4525doModel final : public I2cPart {
 public:
  explicit Ms4525doModel(DiffPressureExposure exposure) : exposure_{std::move(exposure)} {}

  std::uint8_t address() const override { return 0x28; }
  void advance(Time now) override { now_ = now; }
  Time next_event() const override { return kNever; }
  void set_power(bool on) override { mute = !on; }
  bool begin(bool read) override {
    if (mute) return false;
    if (!read) return true;
    at_ = 0;
    const DiffPressureTruth truth = exposure_(measured_);
    const bool stale = now_ - measured_ < Time{500};
    const unsigned status = fault ? 3 : stale || stuck_stale ? 2 : 0;
    const double psi = truth.pressure_Pa / 6894.76;
    const auto raw =
        static_cast<unsigned>(std::clamp(std::lround((psi + 1.0) * 6553.2 + 1638.3), 0l, 16383l));
    const double celsius = truth.temperature_K - 273.15;
    const auto hot = static_cast<unsigned>(
        std::clamp(std::lround((celsius + 50.0) * 2047.0 / 200.0), 0l, 2047l));
    out_ = {static_cast<std::uint8_t>(status << 6 | raw >> 8),
            static_cast<std::uint8_t>(raw & 0xFFu), static_cast<std::uint8_t>(hot >> 3),
            static_cast<std::uint8_t>((hot & 7u) << 5)};
    measured_ = now_;
    return true;
  }
  bool write(std::uint8_t /*byte*/) override { return true; }
  std::uint8_t read() override {
    ++bytes_read;
    return at_ < out_.size() ? out_[at_++] : std::uint8_t{0xFF};
  }
  void stop() override {}

  bool mute{false};
  bool fault{false};
  bool stuck_stale{false};
  std::size_t bytes_read{0};  ///< Since construction.

 private:
  DiffPressureExposure exposure_;
  std::array<std::uint8_t, 4> out_{};
  std::size_t at_{0};
  Time now_{};
  Time measured_{};  ///< When the last reading started the measurement that the next will return.
};

/// All Sensors DLHR-L20G: commands of three bytes, busy bit, end-of-conversion line, status and
/// 24-bit data.
class DlhrModel final : public I2cPart {
 public:
  explicit DlhrModel(DiffPressureExposure exposure) : exposure_{std::move(exposure)} {}

  std::uint8_t address() const override { return 0x29; }
  void advance(Time now) override {
    if (done_ <= now) finish();
    now_ = now;
  }
  Time next_event() const override { return done_; }
  void set_power(bool on) override { mute = !on; }
  bool begin(bool read) override {
    if (mute) return false;
    if (read) {
      const auto status =
          static_cast<std::uint8_t>(error_bits | 0x40u | (done_ != kNever ? 0x20u : 0u));
      out_[0] = status;
      at_ = 0;
    }
    command_ = 0;
    received_ = 0;  // a start ends what a reset of the chip cut off
    return true;
  }
  bool write(std::uint8_t byte) override {
    command_ = command_ << 8 | byte;
    ++received_;
    return true;
  }
  std::uint8_t read() override { return at_ < out_.size() ? out_[at_++] : std::uint8_t{0xFF}; }
  void stop() override {
    if (received_ == 0) return;
    if (received_ != 3) complain("a command has three bytes");
    if (received_ == 3 && command_ >> 16 == 0xAC) {
      if (done_ != kNever) complain("commanded during a measurement");
      begun_ = now_;
      done_ = now_ + Time{5200};
      if (line) line(false, now_);
    }
    received_ = 0;
  }

  Line line;
  bool mute{false};
  std::uint8_t error_bits{0};

 private:
  void finish() {
    const DiffPressureTruth truth = exposure_(begun_ + (done_ - begun_) / 2);
    const double fraction = truth.pressure_Pa / (1.25 * 4981.8) + 0.1;
    const double hot = (truth.temperature_K - 273.15 + 40.0) / 125.0;
    put(1, fraction);
    put(4, hot);
    const Time when = done_;
    done_ = kNever;
    if (line) line(true, when);
  }
  void put(std::size_t at, double fraction) {
    const auto raw =
        static_cast<std::uint32_t>(std::clamp(std::lround(fraction * 16777216.0), 0l, 16777215l));
    for (std::size_t k = 0; k < 3; ++k)
      out_[at + k] = static_cast<std::uint8_t>(raw >> (16 - 8 * k) & 0xFFu);
  }

  DiffPressureExposure exposure_;
  std::array<std::uint8_t, 7> out_{};
  std::size_t at_{0};
  std::uint32_t command_{0};
  unsigned received_{0};
  Time now_{};
  Time begun_{};
  Time done_{kNever};
};

}  // namespace rosflight::boards::parts::models
