// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/periodic.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// All Sensors DLHR-L20G differential pressure sensor on I2C at 0x29, 20 inH2O. 100 times per second a
/// measurement of two readings is commanded with three bytes (5.2 ms); the rising edge of its pin, or
/// 8 ms without one, starts the read of seven bytes. Stamp: the middle of the measurement.
///
///     pressure = 1.25 range (raw / 2^24 - 0.1)      [Pa], range = 4981.8 Pa                     (1)
///     temperature = 125 raw / 2^24 - 40             [degC]                                      (2)
///
/// Source: data sheet DLHR series, tables of commands and status.
class Dlhr final : public Driver,
                   public hal::Source<hal::DiffPressureSample>,
                   private TransferOwner {
 public:
  static constexpr std::uint8_t kAddress = 0x29;

  explicit Dlhr(Port& port);
  /// Rising edge of the end-of-conversion pin. Bus context. A board without the pin never calls it.
  void conversion_done(Time edge);
  /// Main loop.
  bool poll(hal::DiffPressureSample& sample) override { return samples_.take(sample); }

  /// Equations (1) and (2), the latter in K.
  static float pressure_Pa(std::uint32_t raw);
  static float temperature_K(std::uint32_t raw);

 private:
  enum class Stage : std::uint8_t { kIdle, kStatus, kCommand, kWaiting, kResult };

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void start(Stage stage, std::size_t out, std::size_t in);
  void result_read(Time end);

  Port& port_;
  Periodic period_;
  Stage stage_{Stage::kIdle};
  bool on_bus_{false};
  std::uint8_t bad_in_a_row_{0};
  Time commanded_{};
  std::array<std::uint8_t, 7> in_{};
  Transfer transfer_{};
  Handover<hal::DiffPressureSample> samples_;
};

}  // namespace rosflight::boards::parts
