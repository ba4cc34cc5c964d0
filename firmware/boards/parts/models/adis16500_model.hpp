// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/models/part.hpp"
#include "firmware/boards/parts/models/truth.hpp"

namespace rosflight::boards::parts::models {

/// Analog Devices ADIS16500: registers of 16 bits behind words on SPI, reset pin, product, status,
/// decimation, bursts of 16 and 32 bits with checksum, data-ready pin. Its samples follow the clock that
/// it is given; each shows what it was exposed to 1510 us before.
class Adis16500Model final : public SpiPart {
 public:
  using Exposure = std::function<ImuTruth(Time)>;

  explicit Adis16500Model(Exposure exposure) : exposure_{std::move(exposure)} { reset(); }

  void advance(Time now) override;
  Time next_event() const override { return runs() ? next_ : kNever; }
  void set_power(bool on) override;
  void select(bool selected) override;
  std::uint8_t exchange(std::uint8_t out) override;
  /// The chip was reset in the middle of a word, which is lost; the pin floats and select(false) follows.
  void abandon() { selected_ = false; }
  /// The reset pin; low stops the part, high starts it.
  void reset_pin(bool high);
  /// Mean age, at its data-ready edge, of what a sample shows.
  double delay_us() const;

  std::uint16_t reg(std::uint8_t address) const { return registers_[address / 2]; }
  void set_reg(std::uint8_t address, std::uint16_t value) { registers_[address / 2] = value; }

  Line line;
  bool mute{false};
  bool no_edges{false};
  bool sync_clock{true};  ///< 2 kHz at its clock input.
  bool wrong_checksum{false};
  int lose_writes{0};
  std::uint16_t status{0};  ///< Reported in the register and in bursts.
  std::uint16_t product{0x4074};
  std::uint64_t samples{0};

 private:
  void reset();
  bool runs() const { return powered_ && pin_high_ && sync_clock; }
  void sample();
  void fill_burst();
  std::uint16_t read(std::uint8_t address) const;

  Exposure exposure_;
  std::array<std::uint16_t, 64> registers_{};
  std::array<double, 6> sum_{};
  std::array<std::int32_t, 6> values_{};
  std::int16_t temperature_{};
  std::uint16_t counter_{0};
  unsigned averaged_{0};
  bool powered_{true};
  bool pin_high_{true};
  bool selected_{false};
  Time now_{};
  Time next_{};
  Time ready_{};
  Time last_word_{-1000};
  std::uint16_t answer_{0};  ///< To the word before.
  std::array<std::uint8_t, 2> word_{};
  std::size_t count_{0};
  std::vector<std::uint8_t> burst_;
};

}  // namespace rosflight::boards::parts::models
