// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/ubx.hpp"

#include "firmware/boards/parts/bytes.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint8_t kSync1 = 0xB5, kSync2 = 0x62;

std::uint8_t hex_digit(unsigned value) {
  return static_cast<std::uint8_t>("0123456789ABCDEF"[value & 15u]);
}

}  // namespace

UbxFormat::Sums UbxFormat::sums(const std::uint8_t* data, std::size_t size) {
  unsigned a = 0;
  unsigned b = 0;
  for (std::size_t k = 0; k < size; ++k) {
    a += data[k];
    b += a;
  }
  return {static_cast<std::uint8_t>(a & 0xFFu), static_cast<std::uint8_t>(b & 0xFFu)};
}

Finding UbxFormat::inspect(const std::uint8_t* data, std::size_t size) {
  if (data[0] != kSync1 || (size > 1 && data[1] != kSync2)) return {Finding::kStray};
  if (size < 6) return {Finding::kMore};
  const std::size_t length = static_cast<std::uint16_t>(le16(data + 4));
  if (length > kMaxPayload) return {Finding::kStray};
  if (size < length + kAround) return {Finding::kMore};
  const Sums expected = sums(data + 2, length + 4);
  const bool right = data[length + 6] == expected.a && data[length + 7] == expected.b;
  return {right ? Finding::kFrame : Finding::kDamaged, length + kAround};
}

std::size_t UbxFormat::wrap(std::uint8_t message_class, std::uint8_t id,
                            const std::uint8_t* payload, std::size_t size, std::uint8_t* frame) {
  frame[0] = kSync1;
  frame[1] = kSync2;
  frame[2] = message_class;
  frame[3] = id;
  put_le16(frame + 4, static_cast<std::uint16_t>(size));
  std::copy(payload, payload + size, frame + 6);
  const Sums sum = sums(frame + 2, size + 4);
  frame[size + 6] = sum.a;
  frame[size + 7] = sum.b;
  return size + kAround;
}

Finding NmeaFormat::inspect(const std::uint8_t* data, std::size_t size) {
  if (data[0] != '$') return {Finding::kStray};
  unsigned sum = 0;
  for (std::size_t k = 1; k < size; ++k) {
    if (data[k] == '*') {
      if (size < k + 3) return {Finding::kMore};
      const bool right = data[k + 1] == hex_digit(sum >> 4) && data[k + 2] == hex_digit(sum);
      return {right ? Finding::kFrame : Finding::kDamaged, k + 3};
    }
    if (data[k] < 0x20 || data[k] > 0x7E || k + 3 >= kMaxLength) return {Finding::kStray};
    sum ^= data[k];
  }
  return {Finding::kMore};
}

/// Days by the formula for the civil calendar with years that begin in March.
std::int64_t unix_seconds(int year, int month, int day, int hour, int minute, int second) {
  const int y = month <= 2 ? year - 1 : year;
  const int m = month <= 2 ? month + 9 : month - 3;  // March is 0
  const int days = 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1;
  constexpr int kDaysTo1970 = 719'468;
  const int of_day = (hour * 60 + minute) * 60 + second;
  return std::int64_t{86'400} * (days - kDaysTo1970) + of_day;
}

NavPvt NavPvt::from(const std::uint8_t* p) {
  constexpr std::int32_t kBillion = 1'000'000'000;
  constexpr unsigned kDateTimeResolved = 7;
  NavPvt pvt;
  hal::GnssSample& s = pvt.sample;
  pvt.time_resolved = (p[11] & kDateTimeResolved) == kDateTimeResolved;
  pvt.nano_ns = le32_signed(p + 16);
  s.unix_s = unix_seconds(static_cast<std::uint16_t>(le16(p + 4)), p[6], p[7], p[8], p[9], p[10]);
  s.unix_ns = pvt.nano_ns;
  if (s.unix_ns < 0) {
    s.unix_ns += kBillion;
    --s.unix_s;
  }
  pvt.fix_ok = (p[21] & 1u) != 0;
  s.fix = pvt.fix_ok && p[20] <= 5 ? static_cast<hal::GnssFix>(p[20]) : hal::GnssFix::kNone;
  s.satellites = p[23];
  const auto within = [](std::int32_t value, std::int32_t limit) {
    return value >= -limit && value <= limit;
  };
  constexpr std::int32_t kMaxLatitude = 900'000'000, kMaxLongitude = 1'800'000'000;  // 1e-7 deg
  pvt.plausible = within(pvt.nano_ns, kBillion - 1) && within(le32_signed(p + 24), kMaxLongitude) &&
                  within(le32_signed(p + 28), kMaxLatitude);
  s.longitude_deg = 1e-7 * static_cast<double>(le32_signed(p + 24));
  s.latitude_deg = 1e-7 * static_cast<double>(le32_signed(p + 28));
  const auto metres = [p](std::size_t at) {
    return 1e-3f * static_cast<float>(le32_signed(p + at));
  };
  s.height_msl_m = metres(36);
  s.horizontal_accuracy_m = 1e-3f * static_cast<float>(le32(p + 40));
  s.vertical_accuracy_m = 1e-3f * static_cast<float>(le32(p + 44));
  s.velocity_ned_m_s = {metres(48), metres(52), metres(56)};
  s.speed_accuracy_m_s = 1e-3f * static_cast<float>(le32(p + 68));
  return pvt;
}

}  // namespace rosflight::boards::parts
