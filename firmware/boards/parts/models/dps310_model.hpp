// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/models/registers.hpp"

namespace rosflight::boards::parts::models {

struct BaroTruth {
  double pressure_Pa{100e3};
  double temperature_K{298.15};
};

/// Infineon DPS310: identity, soft reset, start-up, wires, coefficients, rate and oversampling,
/// single and continuous measurements with their times, ready bits that a read clears, data.
///
/// A raw value is found from the exposure by inverting the compensation, so a driver that computes
/// otherwise than the data sheet is off.
class Dps310Model final : public SpiRegisters {
 public:
  using Exposure = std::function<BaroTruth(Time)>;

  /// @param three_wires  how it is soldered: until 0x09 says so, reads find an undriven line.
  Dps310Model(Exposure exposure, bool three_wires);

  void advance(Time now) override;
  Time next_event() const override { return done_; }
  void set_power(bool on) override;

  /// Needs the writes of the work-around, without which its temperature reads 60 K too high.
  bool needs_work_around{false};
  /// Measurements never end.
  bool stalls{false};

 private:
  std::uint8_t read_register(std::uint8_t reg) override;
  void write_register(std::uint8_t reg, std::uint8_t value) override;
  void reset();
  void measure();
  void finish();
  void put24(std::uint8_t reg, double raw);

  Exposure exposure_;
  bool three_wires_;
  Time now_{};
  Time reset_at_{};
  Time begun_{};
  Time done_{kNever};
  unsigned kind_{0};       ///< Kind of measurement: 1 pressure, 2 temperature.
  unsigned unlocking_{0};  ///< Writes of the work-around so far.
  bool worked_around_{false};
};

}  // namespace rosflight::boards::parts::models
