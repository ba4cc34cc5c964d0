// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/driver.hpp"
#include "firmware/boards/parts/handover.hpp"
#include "firmware/boards/parts/mounting.hpp"
#include "firmware/boards/parts/setup.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::parts {

/// Bosch BMI088, accelerometer and gyro behind two chip selects of one SPI. Every rising edge of the
/// gyro's data-ready pin (INT3) starts two transfers, of 8 and 7 bytes: accelerometer, then gyro. The
/// accelerometer runs by itself at 1600 Hz and is up to 625 us old; the vendor's synchronisation,
/// which needs a program of 6 kB in the part, is not used.
///
/// Stamp: the edge minus the group delay of the gyro's filter. The data sheet does not state it; that
/// of a second-order Butterworth filter with the bandwidth of the data sheet is used,
///
///     delay = sqrt(2) / (2 pi bandwidth)                                                        (1)
///
/// Scales: rate = raw range / 32768, acceleration = raw range / 32768, temperature
/// = 0.125 raw + 23 degC of 11 bits. Source: data sheet BST-BMI088-DS001, register maps.
class Bmi088 final : public Driver, public hal::Source<hal::ImuSample>, private TransferOwner {
 public:
  static constexpr SpiWish kSpi{3, 10'000'000, false};
  /// Without an edge for so long the part has failed; it is set up again.
  static constexpr Time kEdgeTimeout = hal::milliseconds(20);

  enum class GyroRate : std::uint8_t {  ///< Register 0x10: samples per second, bandwidth.
    k2000Hz532 = 0,
    k2000Hz230 = 1,
    k1000Hz116 = 2,
    k400Hz47 = 3
  };
  enum class GyroRange : std::uint8_t { k2000 = 0, k1000 = 1, k500 = 2, k250 = 3, k125 = 4 };
  enum class AccelRange : std::uint8_t { k3g = 0, k6g = 1, k12g = 2, k24g = 3 };

  struct Config {
    GyroRate gyro_rate{GyroRate::k2000Hz230};
    GyroRange gyro_range{GyroRange::k2000};
    AccelRange accel_range{AccelRange::k24g};
    Mounting mounting{};  ///< Both dies share their axes.
  };

  /// Ports must outlive this; both urgent.
  Bmi088(Port& accel, Port& gyro, const Config& config);

  /// Rising edge of INT3. Bus context. @param edge  from a timer capture or the start of the handler.
  void data_ready(Time edge);
  /// Main loop.
  bool poll(hal::ImuSample& sample) override { return samples_.take(sample); }

  /// Samples handed over since the start. Bus context.
  std::uint32_t count() const { return samples_.count(); }
  /// Edges that came while the last sample was still being read.
  std::uint32_t overruns() const { return overruns_; }
  /// Samples lost because the main loop was too slow.
  std::uint32_t dropped() const { return samples_.dropped(); }
  static Time group_delay(GyroRate rate);

 private:
  static constexpr std::size_t kAccelSteps = 9;
  static constexpr std::size_t kGyroSteps = 8;
  enum class Stage : std::uint8_t { kIdle, kAccel, kGyro, kTemperature };

  bool begin(Start how, Time now) override;
  void step_start(Time now) override;
  void step_running(Time now) override;
  void transfer_done(Transfer& transfer, TransferResult result, Time end) override;
  void read(Stage stage, Port& port, std::uint8_t reg, std::size_t dummy, std::size_t count);
  void hand_over(Time now);
  static std::array<SetupStep, kAccelSteps> accel_steps(const Config& config);
  static std::array<SetupStep, kGyroSteps> gyro_steps(const Config& config);

  Config config_;
  Port& accel_;
  Port& gyro_;
  std::array<SetupStep, kAccelSteps> accel_steps_;
  std::array<SetupStep, kGyroSteps> gyro_steps_;
  Setup accel_setup_;
  Setup gyro_setup_;
  float accel_scale_m_s2_;
  float gyro_scale_rad_s_;

  Stage stage_{Stage::kIdle};
  Time edge_{};
  Time last_edge_{};
  Time delay_{};
  std::array<std::uint8_t, 2> out_{};
  std::array<std::uint8_t, 6> raw_accel_{};
  std::array<std::uint8_t, 6> raw_gyro_{};
  std::array<std::uint8_t, 2> raw_temperature_{};
  Transfer transfer_{};
  float temperature_K_{};
  Time temperature_at_{};
  std::uint8_t empty_in_a_row_{0};
  std::uint32_t overruns_{0};
  Handover<hal::ImuSample> samples_;
};

}  // namespace rosflight::boards::parts
