// SPDX-License-Identifier: BSD-3-Clause
#include "companion/streams.hpp"

#include <algorithm>

namespace rosflight::companion {

namespace {
// An unstamped message belongs to the last IMU sample if that arrived so shortly before; 20 ms is eight
// periods at 400 Hz. Both may be much older: after a stall of the computer all bytes arrive at once.
constexpr Time kBorrowWithin = std::chrono::milliseconds{20};
// A sample cannot come from the future, bar the error of the offset.
constexpr Time kClockSlack = std::chrono::milliseconds{1};
}  // namespace

std::optional<Time> fcu_time(std::uint64_t us) {
  constexpr std::uint64_t kLimit_us = std::uint64_t{1} << 52;  // 143 years; times 1000 still fits
  if (us >= kLimit_us) {
    return std::nullopt;
  }
  return Time{static_cast<std::int64_t>(us) * 1000};
}

void Streams::update_rates(Time now) {
  const double dt_s = to_seconds(now - rates_since_);
  rates_since_ = now;
  if (dt_s <= 0.0) {
    return;
  }
  for_each([dt_s](auto& stream) {
    stream.rate_hz = static_cast<double>(stream.count - stream.counted) / dt_s;
    stream.counted = stream.count;
  });
}

Stamp Streams::stamp_us(std::uint64_t time_boot_us, Time now, const TimeSync& sync) {
  const auto fcu = fcu_time(time_boot_us);
  if (!fcu || !sync.synchronised()) {
    return {now, now, StampSource::kArrival};
  }
  return {now, sync.to_companion(*fcu), StampSource::kFcuClock};
}

Stamp Streams::stamp(const link::Imu& m, Time now, const TimeSync& sync) {
  last_imu_us_ = m.time_boot_us;
  last_imu_arrival_ = now;
  return stamp_us(m.time_boot_us, now, sync);
}

Stamp Streams::stamp_with_imu_ms(std::uint64_t time_boot_ms, Time now, const TimeSync& sync) const {
  if (last_imu_us_ && *last_imu_us_ / 1000 == time_boot_ms) {
    return stamp_us(*last_imu_us_, now, sync);
  }
  constexpr std::uint64_t kLimit_ms = std::uint64_t{1} << 52;
  return stamp_us(time_boot_ms < kLimit_ms ? time_boot_ms * 1000 : kLimit_ms, now, sync);
}

Stamp Streams::stamp_unstamped(Time now, const TimeSync& sync) const {
  if (last_imu_us_) {
    const Stamp borrowed = stamp_us(*last_imu_us_, now, sync);
    if (borrowed.source == StampSource::kFcuClock && borrowed.sample < now + kClockSlack &&
        now - last_imu_arrival_ <= kBorrowWithin) {
      return {now, std::min(borrowed.sample, now), StampSource::kImuPass};
    }
  }
  return {now, now, StampSource::kArrival};
}

}  // namespace rosflight::companion
