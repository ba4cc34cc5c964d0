// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/framer.hpp"
#include "firmware/hal/samples.hpp"

namespace rosflight::boards::parts {

/// Frames of u-blox receivers:
///
///     0xB5 0x62 | class | id | length u16 | payload | two sums over class .. payload
///
/// Source: u-blox M9 interface description, "UBX frame structure". Longer payloads than kMaxPayload begin
/// no frame, so that a damaged length does not swallow what follows.
struct UbxFormat {
  static constexpr std::size_t kAround = 8;
  static constexpr std::size_t kMaxPayload = 256;
  static constexpr std::size_t kMaxLength = kMaxPayload + kAround;

  static Finding inspect(const std::uint8_t* data, std::size_t size);
  struct Sums {
    std::uint8_t a{}, b{};
  };
  /// 8-bit Fletcher.
  static Sums sums(const std::uint8_t* data, std::size_t size);
  /// Puts sync, length and sums around `size` bytes of payload, of which `frame` has room for
  /// size + kAround. @returns the size of the frame.
  static std::size_t wrap(std::uint8_t message_class, std::uint8_t id, const std::uint8_t* payload,
                          std::size_t size, std::uint8_t* frame);
};

/// Sentences of NMEA 0183, to recognize a receiver that speaks it: "$" ... "*" and two hex digits.
struct NmeaFormat {
  static constexpr std::size_t kMaxLength = 100;
  static Finding inspect(const std::uint8_t* data, std::size_t size);
};

/// What the driver needs of NAV-PVT (0x01 0x07, 92 bytes).
struct NavPvt {
  static constexpr std::size_t kBytes = 92;
  static constexpr std::uint8_t kClass = 0x01, kId = 0x07;

  hal::GnssSample sample{};  ///< All but the stamp.
  std::int32_t nano_ns{};    ///< Time of validity after the whole second; may be negative.
  bool time_resolved{};      ///< Date, time and leap seconds are known.
  bool fix_ok{};
  /// Fraction of a second, latitude and longitude lie within their ranges.
  bool plausible{};

  static NavPvt from(const std::uint8_t* payload);
};

/// Seconds from 1970-01-01 to a civil date and time, Gregorian calendar, no leap seconds.
std::int64_t unix_seconds(int year, int month, int day, int hour, int minute, int second);

}  // namespace rosflight::boards::parts
