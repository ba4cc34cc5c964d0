// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/periodic.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// TE MS4525DO differential pressure sensor on I2C at 0x28, output type A, +-1 psi. It has neither
/// registers nor set-up: reading it returns the last measurement and starts the next: two bytes of
/// pressure, and two more of temperature if they are asked for. Five readings, 2 ms apart, are averaged to a
/// sample, the last with the temperature; 100 samples per second. Stale readings do not count,
/// a reported fault is an error. Stamp: the middle of the readings.
///
///     pressure = ((raw - 1638.3) / 6553.2 - 1) 6894.76  [Pa]                                    (1)
///     temperature = 200 raw / 2047 - 50                 [degC]                                  (2)
///
/// Source: data sheet MS4525DO, "output at 10 % .. 90 %".
class Ms4525do final : public Driver,
                       public hal::Source<hal::DiffPressureSample>,
                       private TransferOwner {
 public:
  static constexpr std::uint8_t kAddress = 0x28;

  explicit Ms4525do(Port& port);
  /// Main loop.
  bool poll(hal::DiffPressureSample& sample) override { return samples_.take(sample); }
  /// Samples handed over since the start. Bus context.
  std::uint32_t count() const { return samples_.count(); }

  /// Equations (1) and (2), the latter in K. @param raw  14 and 11 bits.
  static float pressure_Pa(float raw);
  static float temperature_K(float raw);

 private:
  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void use_reading(Time end);

  Port& port_;
  Periodic period_;
  bool on_bus_{false};
  std::uint8_t faults_in_a_row_{0};
  std::array<std::uint8_t, 4> in_{};
  Transfer transfer_{};
  float sum_{0.0f};
  int count_{0};
  Time first_{};
  Handover<hal::DiffPressureSample> samples_;
};

}  // namespace rosflight::boards::parts
