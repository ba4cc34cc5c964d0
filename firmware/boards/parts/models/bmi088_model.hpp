// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "firmware/boards/parts/models/filter.hpp"
#include "firmware/boards/parts/models/registers.hpp"
#include "firmware/boards/parts/models/truth.hpp"

namespace rosflight::boards::parts::models {

/// Bosch BMI088: two dies with a chip select each. Registers of identity, soft reset, power, range,
/// rate and filter, data-ready pin, data, sensor time and temperature; the rest are memory.
///
/// Each die samples what it is exposed to 8000 times a second, filters it with the bandwidth that is
/// set, and puts out a sample at its rate. Sample instants do not care about transfers, and the rate is
/// off by `clock_error`, as that of the part's own oscillator is.
class Bmi088Model {
 public:
  using Exposure = std::function<ImuTruth(Time)>;

  class Accelerometer final : public SpiRegisters {
   public:
    Accelerometer(const Exposure& exposure, const double& clock_error);
    void advance(Time now) override;
    Time next_event() const override { return on() ? next_ : kNever; }
    void set_power(bool on) override;

   private:
    std::uint8_t read_register(std::uint8_t reg) override;
    void write_register(std::uint8_t reg, std::uint8_t value) override;
    void deselected() override;
    bool on() const { return powered_ && registers[0x7D] == 0x04 && registers[0x7C] == 0x00; }
    void reset(Time now);
    void sample();

    const Exposure& exposure_;
    const double& clock_error_;
    std::array<LowPass, 3> filter_;
    double phase_us_{0.0};
    unsigned internal_{0};
    Time now_{};
    Time next_{};
    Time ready_{};     ///< End of the start-up time after reset or change of power.
    bool spi_{false};  ///< The chip select rose once since the reset.
    bool reset_commanded_{false};
  };

  class Gyro final : public SpiRegisters {
   public:
    Gyro(const Exposure& exposure, const double& clock_error);
    void advance(Time now) override;
    Time next_event() const override;
    void set_power(bool on) override;
    /// INT3.
    Line line;
    /// Samples put out since the power came.
    std::uint64_t samples() const { return samples_; }
    /// Age of what a sample shows, of its filter, at its data-ready edge.
    double delay_us() const;

   private:
    std::uint8_t read_register(std::uint8_t reg) override;
    void write_register(std::uint8_t reg, std::uint8_t value) override;
    bool on() const { return powered_ && registers[0x11] == 0x00; }
    void reset(Time now);
    void sample(Time now);

    const Exposure& exposure_;
    const double& clock_error_;
    std::array<LowPass, 3> filter_;
    double phase_us_{0.0};
    unsigned internal_{0};
    std::uint64_t samples_{0};
    Time now_{};
    Time next_{};
    Time line_falls_{kNever};
    Time ready_{};
  };

  /// @param exposure  called with ascending times.
  explicit Bmi088Model(Exposure exposure) : exposure_{std::move(exposure)} {}
  Bmi088Model(const Bmi088Model&) = delete;
  Bmi088Model& operator=(const Bmi088Model&) = delete;

  double clock_error{0.0};  ///< Relative; 0.01 makes each period 1 % longer.

 private:
  Exposure exposure_;

 public:
  Accelerometer accel{exposure_, clock_error};
  Gyro gyro{exposure_, clock_error};
};

}  // namespace rosflight::boards::parts::models
