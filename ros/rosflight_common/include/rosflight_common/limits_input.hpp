// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/fence.hpp>
#include <string>

#include "autonomy/common/flight_limits.hpp"

namespace rosflight_common {

namespace autonomy = rosflight::autonomy;

/// Name and durability (latched) of the topic that has the fence in force.
inline constexpr const char* kFenceTopic = "mission/fence";

/// The fence of a message; absent unless both of its numbers are positive. Infinity is no limit in that direction.
inline std::optional<autonomy::Fence> fence_of(const rosflight_msgs::msg::Fence& m) {
  if (!(m.radius > 0.0) || !(m.height > 0.0)) return {};
  return autonomy::Fence{m.radius, m.height};
}

inline rosflight_msgs::msg::Fence message_of(const std::optional<autonomy::Fence>& fence) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  rosflight_msgs::msg::Fence m;
  m.radius = fence ? fence->radius_m : kNone;
  m.height = fence ? fence->height_m : kNone;
  return m;
}

/// Battery and fence for the stacks: takes the messages of the topics `battery` and `mission/fence`, gives what
/// autonomy::FlightLimits judges, and the text of what it decides. Knows no node; times are of one clock [s].
class LimitsInput {
 public:
  static constexpr double kMaxAge_s = 2.0;  ///< An older measurement of the battery is not judged.

  /// @param battery  the pack of the vehicle file, with its levels.
  explicit LimitsInput(const autonomy::BatteryConfig& battery) : battery_{battery} {}

  /// A measurement with a number that is not finite counts as none.
  void take(const rosflight_msgs::msg::BatteryStatus& message, double received_s) {
    if (!std::isfinite(message.voltage) || !std::isfinite(message.current)) return;
    voltage_V_ = static_cast<double>(message.voltage);
    current_A_ = static_cast<double>(message.current);
    received_s_ = received_s;
  }

  /// @return  whether it is another fence than the one before.
  bool take(const rosflight_msgs::msg::Fence& message) {
    const auto before = fence_;
    fence_ = fence_of(message);
    return fence_ != before;
  }

  /// The part of a Status that FlightLimits needs.
  void fill(double now_s, autonomy::Status& status) const {
    status.battery_voltage_V = voltage_V_;
    status.battery_current_A = current_A_;
    status.battery_fresh = std::abs(now_s - received_s_) < kMaxAge_s;
  }

  const std::optional<autonomy::Fence>& fence() const { return fence_; }
  const autonomy::BatteryConfig& battery() const { return battery_; }

  /// As autonomy::takeoff_fault().
  std::string takeoff_fault(double now_s) const {
    return autonomy::takeoff_fault(battery_, sample(now_s));
  }

  /// What a pilot should know when the flight begins: that nobody judges a battery of which the vehicle file has cells. Else empty.
  std::string not_judged(double now_s) const {
    const bool judged =
        !(battery_.cells > 0.0) || autonomy::cell_at_rest_V(battery_, sample(now_s));
    return judged ? "" : "battery: found no voltage: the flight does not end when it is low";
  }

  /// The fence in force, in one line.
  std::string fence_text() const {
    if (!fence_) return "fence: none";
    return print("fence: %g m around the start, %g m high", fence_->radius_m, fence_->height_m);
  }

  /// A decision of FlightLimits in one line, with the numbers that it was made of.
  /// @param charge  share of the capacity that is left, by BatteryWatch.
  std::string text(autonomy::FlightEventType type, double now_s, double charge) const {
    using Type = autonomy::FlightEventType;
    const std::string what = autonomy::name(type);
    if (type == Type::kFenceCrossed && fence_)
      return what +
             print(" (%g m around the start, %g m high)", fence_->radius_m, fence_->height_m);
    const bool battery =
        type == Type::kBatteryLow || type == Type::kBatteryReturn || type == Type::kBatteryLand;
    if (!battery) return what;
    const auto cell_V = autonomy::cell_at_rest_V(battery_, sample(now_s));
    const std::string volts =
        cell_V ? print("%.2f V in each of %g cells at rest, ", *cell_V, battery_.cells) : "";
    return what + " (" + volts +
           print("%.0f %% of %g A h left)", 100.0 * charge, battery_.capacity_Ah);
  }

 private:
  autonomy::BatteryWatch::Sample sample(double now_s) const {
    autonomy::Status status;
    fill(now_s, status);
    return {status.battery_voltage_V, status.battery_current_A, status.battery_fresh};
  }

  template <std::size_t N>
  static std::string print(const char (&format)[N], double a, double b) {
    std::array<char, 120> text{};
    std::snprintf(text.data(), text.size(), format, a, b);
    return text.data();
  }

  autonomy::BatteryConfig battery_;
  std::optional<autonomy::Fence> fence_;
  double voltage_V_{};
  double current_A_{};
  double received_s_{-std::numeric_limits<double>::infinity()};
};

}  // namespace rosflight_common
