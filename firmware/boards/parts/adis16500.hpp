// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/mounting.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// Analog Devices ADIS16500 on SPI with words of 16 bits, in direct synchronization: a clock of 2 kHz,
/// which the board gives from before the start, paces its samples; the part averages 2000 / rate of them.
/// Each rising edge of its data-ready pin starts one burst of 34 bytes with 32-bit values and a checksum.
/// Words of set-up need 16 us in between and go one per tick.
///
///     delay of a sample = 1510 us + 500 000 us / rate_hz - 250 us                               (1)
///
/// is subtracted from the edge. Scales: 0.1 deg/s and 0.01225 m/s2 per LSB of the upper 16 bits, 0.1 K per
/// LSB. A burst with a wrong checksum, or with a status other than 0, is dropped and counted.
/// Source: data sheet ADIS16500, registers DIAG_STAT to DEC_RATE, burst read.
class Adis16500 final : public Driver, public hal::Source<hal::ImuSample>, private TransferOwner {
 public:
  static constexpr SpiWish kSpi{3, 1'000'000, false};
  static constexpr Time kEdgeTimeout = hal::milliseconds(20);

  struct Config {
    std::uint16_t rate_hz{400};  ///< A divisor of 2000.
    Mounting mounting{};
  };

  /// @param reset  low resets the part.
  Adis16500(Port& port, OutputPin& reset, const Config& config);

  /// Rising edge of the data-ready pin. Bus context.
  void data_ready(Time edge);
  /// Main loop.
  bool poll(hal::ImuSample& sample) override { return samples_.take(sample); }

  std::uint32_t overruns() const { return overruns_; }
  std::uint32_t dropped() const { return samples_.dropped(); }
  /// Equation (1).
  static Time group_delay(std::uint16_t rate_hz);

 private:
  static constexpr std::size_t kBurstBytes = 32;
  static constexpr std::size_t kRows = 5;
  struct Row {
    std::uint8_t reg{};
    std::uint16_t value{};
    bool configure{};  ///< Is written; otherwise only compared.
  };
  enum class Stage : std::uint8_t {
    kResetLow,
    kResetHigh,
    kWriteLow,
    kWriteHigh,
    kAsk,
    kAnswer,
    kIdle,
    kBurst
  };

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void send_word(std::uint8_t first, std::uint8_t second);
  void next_row();
  void answered(Time now);
  void use_burst(Time now);

  Port& port_;
  OutputPin& reset_;
  Config config_;
  std::array<Row, kRows> rows_;
  Time delay_;
  Stage stage_{Stage::kIdle};
  Start how_{Start::kCold};
  std::size_t row_{0};
  std::uint8_t attempts_{0};
  bool on_bus_{false};
  std::uint8_t bad_in_a_row_{0};
  Time wait_until_{};
  Time edge_{};
  Time last_edge_{};
  std::array<std::uint8_t, 2> out_{};
  std::array<std::uint8_t, kBurstBytes> in_{};
  Transfer transfer_{};
  std::uint32_t overruns_{0};
  Handover<hal::ImuSample> samples_;
};

}  // namespace rosflight::boards::parts
