// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/setup.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// Infineon DPS310 barometer on SPI with three or four wires. Pressure (8 times oversampled, 14.8 ms)
/// and temperature (once, 3.6 ms) are commanded in turn, so a sample comes every 21 ms with a tick of
/// 1 ms. Stamp: the middle of the pressure measurement. With the factory's coefficients c and
/// q, t the raw values over their scale factors,
///
///     p = c00 + q (c10 + q (c20 + q c30)) + t c01 + t q (c11 + q c21)   [Pa]                    (1)
///     T = c0 / 2 + c1 t                                                 [degC]                  (2)
///
/// Source: data sheet DPS310, sections 4.9 and 8.
class Dps310 final : public Driver, public hal::Source<hal::BaroSample>, private TransferOwner {
 public:
  static SpiWish spi(bool three_wires) { return {3, 10'000'000, three_wires}; }

  /// @param three_wires  data in and out share a line; configured before the first read.
  Dps310(Port& port, bool three_wires);

  /// Main loop.
  bool poll(hal::BaroSample& sample) override { return samples_.take(sample); }
  /// Samples handed over since the start. Bus context.
  std::uint32_t count() const { return samples_.count(); }

  struct Coefficients {
    std::int32_t c0{}, c1{}, c00{}, c10{}, c01{}, c11{}, c20{}, c21{}, c30{};
  };
  /// Coefficients from the registers 0x10..0x21.
  static Coefficients unpack(const std::array<std::uint8_t, 18>& registers);
  /// Equation (1) [Pa] and (2) [K]. @param q, t  raw values over their scale factors.
  static float pressure_Pa(const Coefficients& c, float q, float t);
  static float temperature_K(const Coefficients& c, float t);

 private:
  static constexpr std::size_t kSteps = 13;
  enum class Stage : std::uint8_t {
    kSetup,
    kSource,  ///< Which temperature sensor the coefficients belong to.
    kCoefficients,
    kConfigure,  ///< Writes that sensor's choice.
    kCommand,    ///< A measurement is being commanded ...
    kMeasuring,  ///< ... goes on, until due_ ...
    kStatus,     ///< ... its ready bit is being read ...
    kResult      ///< ... and its value.
  };

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void advance_start(Time now);
  void command(bool pressure);
  void status_read(Time now);
  void result_read();
  void read(Stage stage, std::uint8_t reg, std::size_t count);
  void write(Stage stage, std::uint8_t reg, std::uint8_t value);
  static std::array<SetupStep, kSteps> steps(bool three_wires);

  Port& port_;
  std::array<SetupStep, kSteps> steps_;
  Setup setup_;
  Stage stage_{Stage::kSetup};
  bool on_bus_{false};
  bool pressure_{false};  ///< What is being measured.
  bool have_temperature_{false};
  std::uint8_t source_{0};
  std::uint8_t late_{0};  ///< Ticks that the result is overdue.
  Time commanded_{};
  Time due_{};
  Coefficients c_{};
  float t_{};
  std::array<std::uint8_t, 2> out_{};
  std::array<std::uint8_t, 18> in_{};
  Transfer transfer_{};
  Handover<hal::BaroSample> samples_;
};

}  // namespace rosflight::boards::parts
