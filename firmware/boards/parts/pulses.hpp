// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

/// Arithmetic of pulses for servos and speed controllers: what goes into the registers of a timer whose
/// channels share one period. No hardware here.
namespace rosflight::boards::parts {

enum class PulseKind : std::uint8_t { kOff, kPwm, kDshot };

/// What a group of channels on one timer is set to.
struct PulsePlan {
  enum class [[nodiscard]] Status : std::uint8_t {
    kOk,
    kMixedRates,  ///< Channels of the group want different rates; the slowest is used.
    kOutOfRange   ///< A rate is neither 0..490 nor 150 000..1 200 000 Hz; that channel is off.
  };
  Status status{Status::kOk};
  PulseKind kind{PulseKind::kOff};
  float rate_hz{0.0f};         ///< In use; 0 if all are off.
  std::uint32_t prescaler{0};  ///< Register value: the timer counts at timer_hz / (prescaler + 1).
  std::uint32_t period{0};     ///< Counts per pulse or bit; the register takes one less.
  float counts_per_us{0.0f};
};

inline constexpr float kMinPwm_hz =
    4.0f;  ///< Slower ones do not fit 16 bits and a pulse of 2 ms well.
inline constexpr float kMaxPwm_hz = 490.0f;
inline constexpr float kMinDshot_hz = 150'000.0f;
inline constexpr float kMaxDshot_hz = 1'200'000.0f;

/// Plans a group. PWM gets the finest count with which a period fits 16 bits; DShot counts undivided.
/// A rate of 0 means that the channel has no pulses, and fits any other.
PulsePlan plan_pulses(const float* rates_hz, std::size_t channels, std::uint32_t timer_hz);

/// Counts of a PWM pulse of 1000 us + 1000 us * value; value is limited to 0..1, NaN is 0.
std::uint32_t pwm_counts(const PulsePlan& plan, float value);

/// DShot throttle: 0 (stopped) for a value of 0 or less and NaN, otherwise 48..2047.
std::uint16_t dshot_throttle(float value);

/// A frame: throttle of 11 bits, telemetry request, checksum
///
///     c = x xor (x >> 4) xor (x >> 8), four bits, x = throttle and request                      (1)
std::uint16_t dshot_frame(std::uint16_t throttle, bool telemetry);

/// Counts of high level for each bit of a frame, first bit first, and a period of low behind them: three
/// quarters of a period are a 1, three eighths a 0.
inline constexpr std::size_t kDshotCounts = 17;
std::array<std::uint16_t, kDshotCounts> dshot_counts(std::uint16_t frame, std::uint32_t period);

}  // namespace rosflight::boards::parts
