// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string_view>

/// Beginnings of the FCU's log lines at the end of a calibration, compared without case: those of
/// ROSflight 2.x, which this firmware sends too, and those that only this firmware sends.
namespace rosflight::companion {

inline constexpr std::string_view kImuSuccess = "IMU offsets captured";
inline constexpr std::string_view kImuMotion = "too much movement for IMU cal";
inline constexpr std::string_view kImuLargeBias = "large accelerometer bias";
inline constexpr std::string_view kGyroSuccess =
    "Gyro calibration complete";  ///< This firmware only.
inline constexpr std::string_view kGyroFailure = "gyro calibration failed";
inline constexpr std::string_view kGyroRefused =
    "gyro calibration refused";  ///< This firmware only.
inline constexpr std::string_view kAccelRefused =
    "accel calibration refused";  ///< This firmware only.
inline constexpr std::string_view kBaroSuccess = "Baro Cal successful!";
inline constexpr std::string_view kBaroMotion = "too much movement for barometer cal";
inline constexpr std::string_view kAirspeedSuccess = "Airspeed Cal Successful!";
inline constexpr std::string_view kAirspeedMotion = "too much movement for diff pressure cal";

/// `line` begins with `prefix`; ASCII case is ignored.
constexpr bool starts_with_text(std::string_view line, std::string_view prefix) {
  constexpr auto kLower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  if (line.size() < prefix.size()) {
    return false;
  }
  for (std::size_t i = 0; i < prefix.size(); ++i) {
    if (kLower(line[i]) != kLower(prefix[i])) {
      return false;
    }
  }
  return true;
}

}  // namespace rosflight::companion
