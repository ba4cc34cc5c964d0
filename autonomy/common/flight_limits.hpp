// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <limits>
#include <optional>

#include "autonomy/common/battery_watch.hpp"
#include "autonomy/common/flight_events.hpp"
#include "autonomy/common/types.hpp"

namespace rosflight::autonomy {

/// A cylinder around the start that a flight does not leave. Key `fence` of a mission file.
struct Fence {
  double radius_m{};  ///< Horizontally.
  double height_m{};  ///< Above the start.

  /// @param from_start_W  position less that of the start.
  bool holds(const Vector3& from_start_W) const {
    return from_start_W.head<2>().norm() <= radius_m && -from_start_W.z() <= height_m;
  }
  bool operator==(const Fence&) const = default;
};

/// How high above the start a return may lead [m]: below the top of the fence, with room for what a vehicle strays.
inline double return_ceiling_m(const std::optional<Fence>& fence) {
  constexpr double kShare = 0.9;
  return fence ? kShare * fence->height_m : std::numeric_limits<double>::infinity();
}

/// What battery and fence ask of a flight, for multirotor and fixed wing alike:
///
///     battery low               reports it
///     battery at its return     returns and lands
///     battery at its landing    lands
///     outside of the fence      returns and lands
///
/// Each adds one event when it begins, and none of them is taken back in flight.
class FlightLimits {
 public:
  /// A flight begins. @param fence  empty: none.
  void start(const BatteryConfig& battery, const std::optional<Fence>& fence) {
    battery_ = BatteryWatch(battery);
    fence_ = fence;
    outside_s_ = 0.0;
    crossed_ = return_ = land_ = false;
  }

  /// That of another mission, in flight: what an earlier fence asked for is over, what the battery asks for stays.
  void set_fence(const std::optional<Fence>& fence) {
    fence_ = fence;
    outside_s_ = 0.0;
    crossed_ = false;
    return_ = battery_.level() >= BatteryLevel::kReturn;
  }

  /// Also in flight; the battery's charge stays.
  void configure(const BatteryConfig& battery) { battery_.configure(battery); }

  /// Once a step in flight.
  /// @param from_start_W  position less that of the start; not finite: the fence is not judged.
  void step(const Status& status, const Vector3& from_start_W, double dt_s, FlightEvents& events) {
    const BatteryLevel before = battery_.level();
    const BatteryLevel now = battery_.step(
        {status.battery_voltage_V, status.battery_current_A, status.battery_fresh}, dt_s);
    if (now != before) {
      events.add(now == BatteryLevel::kWarn     ? FlightEventType::kBatteryLow
                 : now == BatteryLevel::kReturn ? FlightEventType::kBatteryReturn
                                                : FlightEventType::kBatteryLand);
      return_ = return_ || now == BatteryLevel::kReturn;
      land_ = land_ || now == BatteryLevel::kLand;
    }
    const bool outside = fence_ && from_start_W.allFinite() && !fence_->holds(from_start_W);
    outside_s_ = outside ? outside_s_ + dt_s : 0.0;
    if (outside_s_ > kOutside_s && !crossed_) {
      crossed_ = return_ = true;
      events.add(FlightEventType::kFenceCrossed);
    }
  }

  bool asks_return() const { return return_; }
  bool asks_land() const { return land_; }
  const BatteryWatch& battery() const { return battery_; }

 private:
  static constexpr double kOutside_s = 0.5;  // longer than the noise of a position

  BatteryWatch battery_;
  std::optional<Fence> fence_;
  double outside_s_{};
  bool crossed_{false};
  bool return_{false};
  bool land_{false};
};

}  // namespace rosflight::autonomy
