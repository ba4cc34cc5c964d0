// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>

#include "companion/time.hpp"
#include "companion/time_sync.hpp"
#include "link/messages.hpp"

namespace rosflight::companion {

/// The latest message of one kind, the number received and their rate.
template <class T>
struct Latest {
  T value{};
  Stamp stamp;
  std::uint64_t count{0};    ///< Zero: `value` is not valid.
  double rate_hz{0.0};       ///< Over the last update period (1 s).
  std::uint64_t counted{0};  ///< `count` at the last update of the rate.

  /// Stores a received message.
  void set(const T& v, const Stamp& s) {
    value = v;
    stamp = s;
    ++count;
  }
};

/// Latest values of all streams with their stamps. No heap.
class Streams {
 public:
  Latest<link::Heartbeat> heartbeat;
  Latest<link::Status> status;
  Latest<link::Imu> imu;
  Latest<link::Attitude> attitude;
  Latest<link::Mag> mag;
  Latest<link::Baro> baro;
  Latest<link::DiffPressure> diff_pressure;
  Latest<link::Range> range;
  Latest<link::RcChannels> rc;
  Latest<link::OutputRaw> output;
  Latest<link::Gnss> gnss;
  Latest<link::BatteryStatus> battery;

  /// Calls f(latest) for each stream.
  template <class F>
  void for_each(F&& f) {
    f(heartbeat), f(status), f(imu), f(attitude), f(mag), f(baro), f(diff_pressure), f(range);
    f(rc), f(output), f(gnss), f(battery);
  }

  /// Recomputes the rates; called by the session once a second.
  void update_rates(Time now);
  /// Discards the FCU's clock after a restart; values and counts are kept.
  void forget_clock() { last_imu_us_.reset(); }

  // Stamps of received messages. Call them in the order of arrival: others use the IMU's.
  /// The stamp of an IMU sample.
  Stamp stamp(const link::Imu& m, Time now, const TimeSync& sync);
  /// The stamp of a message with milliseconds on the wire. If they equal those of the last IMU sample,
  /// its microseconds are used.
  Stamp stamp_with_imu_ms(std::uint64_t time_boot_ms, Time now, const TimeSync& sync) const;
  /// The stamp of a message with microseconds on the wire.
  static Stamp stamp_us(std::uint64_t time_boot_us, Time now, const TimeSync& sync);
  /// The stamp of a message without a time on the wire.
  Stamp stamp_unstamped(Time now, const TimeSync& sync) const;

 private:
  std::optional<std::uint64_t> last_imu_us_;
  Time last_imu_arrival_{};
  Time rates_since_{};
};

/// FCU microseconds as a duration; nothing for a number beyond 292 years.
std::optional<Time> fcu_time(std::uint64_t us);

}  // namespace rosflight::companion
