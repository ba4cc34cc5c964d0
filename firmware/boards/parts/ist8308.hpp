// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/mounting.hpp"
#include "firmware/boards/parts/periodic.hpp"
#include "firmware/boards/parts/setup.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// Isentek IST8308 magnetometer on I2C at 0x0C, often on the GNSS module outside. 100 single
/// measurements per second, averaged 16 times, +-500 uT at 6.6 LSB/uT on all three axes. The part's z
/// points up and is negated. Stamp: the middle of the
/// measurement of about 8 ms. No temperature.
///
/// Its set-up is compared once per second: a part that lost its power for a moment goes on measuring on
/// demand, but without averaging. Source: the registers as PX4 and ROSflight 2.x use them.
class Ist8308 final : public Driver, public hal::Source<hal::MagSample>, private TransferOwner {
 public:
  static constexpr std::uint8_t kAddress = 0x0C;

  Ist8308(Port& port, const Mounting& mounting);
  /// Main loop.
  bool poll(hal::MagSample& sample) override { return samples_.take(sample); }
  /// Samples handed over since the start. Bus context.
  std::uint32_t count() const { return samples_.count(); }

 private:
  enum class Stage : std::uint8_t { kIdle, kCommand, kWaiting, kResult, kCheck };
  static constexpr std::size_t kSteps = 5;
  static const std::array<SetupStep, kSteps>
      kSetup;  // NOLINT(bugprone-dynamic-static-initializers): constexpr in the .cpp

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void start(Stage stage, std::uint8_t reg, std::size_t out, std::size_t in);
  void result_read(Time end);
  void check_setup(Time end);

  Port& port_;
  Mounting mounting_;
  Setup setup_;
  Periodic period_;
  Stage stage_{Stage::kIdle};
  bool on_bus_{false};
  std::uint8_t late_{0};
  std::uint8_t until_check_{0};
  Time commanded_{};
  std::array<std::uint8_t, 2> out_{};
  std::array<std::uint8_t, 14> in_{};
  Transfer transfer_{};
  Handover<hal::MagSample> samples_;
};

}  // namespace rosflight::boards::parts
