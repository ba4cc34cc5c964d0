// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <tuple>

#include "firmware/hal/samples.hpp"

/// Samples for the contract suites: the k-th has a value of its own in every field and is stamped k
/// milliseconds.
namespace rosflight::hal::contract {

inline Vec3 three(float x, float unit = 1.0f) {
  return {(x + 0.25f) * unit, (x + 0.5f) * unit, (x + 0.75f) * unit};
}

inline ImuSample make(int k, ImuSample /*kind*/) {
  const auto x = static_cast<float>(k);
  return {milliseconds(k), three(x), three(x + 10.0f), x + 290.0f};
}
inline MagSample make(int k, MagSample /*kind*/) {
  const auto x = static_cast<float>(k);
  constexpr float kMicrotesla = 1e-6f;
  return {milliseconds(k), three(x, kMicrotesla), x + 290.0f};
}
inline BaroSample make(int k, BaroSample /*kind*/) {
  const auto x = static_cast<float>(k);
  return {milliseconds(k), x + 101325.0f, x + 290.0f};
}
inline DiffPressureSample make(int k, DiffPressureSample /*kind*/) {
  const auto x = static_cast<float>(k);
  return {milliseconds(k), x - 3.5f, x + 290.0f};
}
inline RangeSample make(int k, RangeSample /*kind*/) {
  const auto x = static_cast<float>(k);
  return {milliseconds(k), x + 1.5f, 0.25f, 40.0f, RangeKind::kLidar};
}
inline GnssSample make(int k, GnssSample /*kind*/) {
  const auto x = static_cast<float>(k);
  GnssSample s;
  s.stamp = milliseconds(k);
  s.unix_s = 1'700'000'000 + k;
  s.unix_ns = 1000 * k;
  s.fix = GnssFix::k3d;
  s.satellites = static_cast<std::uint8_t>(k % 30);
  s.latitude_deg = 40.25 + 1e-6 * k;
  s.longitude_deg = -111.65 + 1e-6 * k;
  s.height_msl_m = x + 1387.0f;
  s.velocity_ned_m_s = three(x);
  s.horizontal_accuracy_m = 0.5f;
  s.vertical_accuracy_m = 0.75f;
  s.speed_accuracy_m_s = 0.25f;
  return s;
}
inline BatterySample make(int k, BatterySample /*kind*/) {
  const auto x = static_cast<float>(k);
  return {milliseconds(k), x + 12.0f, x + 2.0f};
}
/// Good frames of eight channels.
inline RcFrame make(int k, RcFrame /*kind*/) {
  RcFrame s;
  s.stamp = milliseconds(k);
  s.channel_count = 8;
  for (std::size_t c = 0; c < s.channel_count; ++c) {
    s.channels[c] = static_cast<float>((static_cast<std::size_t>(k) + c) % 5) * 0.25f;
  }
  return s;
}

template <class Sample>
Sample make(int k) {
  return make(k, Sample{});
}

inline auto fields(const ImuSample& s) {
  return std::tie(s.stamp, s.accel_m_s2, s.gyro_rad_s, s.temperature_K);
}
inline auto fields(const MagSample& s) {
  return std::tie(s.stamp, s.field_T, s.temperature_K);
}
inline auto fields(const BaroSample& s) {
  return std::tie(s.stamp, s.pressure_Pa, s.temperature_K);
}
inline auto fields(const DiffPressureSample& s) {
  return std::tie(s.stamp, s.pressure_Pa, s.temperature_K);
}
inline auto fields(const RangeSample& s) {
  return std::tie(s.stamp, s.range_m, s.min_m, s.max_m, s.kind);
}
inline auto fields(const GnssSample& s) {
  return std::tie(s.stamp, s.unix_s, s.unix_ns, s.fix, s.satellites, s.latitude_deg,
                  s.longitude_deg, s.height_msl_m, s.velocity_ned_m_s, s.horizontal_accuracy_m,
                  s.vertical_accuracy_m, s.speed_accuracy_m_s);
}
inline auto fields(const BatterySample& s) {
  return std::tie(s.stamp, s.voltage_V, s.current_A);
}
inline auto fields(const RcFrame& s) {
  return std::tie(s.stamp, s.channels, s.channel_count, s.frame_lost, s.failsafe);
}

}  // namespace rosflight::hal::contract
