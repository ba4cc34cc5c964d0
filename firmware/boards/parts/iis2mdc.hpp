// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/mounting.hpp"
#include "firmware/boards/parts/periodic.hpp"
#include "firmware/boards/parts/setup.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// ST IIS2MDC magnetometer on SPI with three wires. One single measurement per 10 ms. The part turns
/// its sensor over between measurements (set, reset), which reverses the sign of its offset; a sample
/// is the mean of two successive measurements, so the offset drops out. Stamp: the middle of the time
/// that both took. 0.15 uT/LSB; the part's z is negated. Temperature 8 LSB/K around 25 degC.
///
/// Each reading contains the set-up registers, so a part that lost them is noticed at once.
/// Source: data sheet IIS2MDC, sections 8.4 to 8.14.
class Iis2mdc final : public Driver, public hal::Source<hal::MagSample>, private TransferOwner {
 public:
  static constexpr SpiWish kSpi{3, 10'000'000, true};

  Iis2mdc(Port& port, const Mounting& mounting);
  /// Main loop.
  bool poll(hal::MagSample& sample) override { return samples_.take(sample); }

 private:
  enum class Stage : std::uint8_t { kIdle, kCommand, kWaiting, kResult };
  static constexpr std::size_t kSteps = 7;
  static constexpr std::size_t kReadBytes = 16;  ///< Registers 0x60..0x6F.
  static const std::array<SetupStep, kSteps>
      kSetup;  // NOLINT(bugprone-dynamic-static-initializers): constexpr in the .cpp

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void command();
  void result_read(Time end);
  void use_result();

  Port& port_;
  Mounting mounting_;
  Setup setup_;
  Stage stage_{Stage::kIdle};
  bool on_bus_{false};
  bool have_previous_{false};
  std::uint8_t late_{0};
  Time commanded_{};
  Time previous_commanded_{};
  hal::Vec3 previous_{};
  std::array<std::uint8_t, 2> out_{};
  std::array<std::uint8_t, kReadBytes> in_{};
  Transfer transfer_{};
  Handover<hal::MagSample> samples_;
};

}  // namespace rosflight::boards::parts
