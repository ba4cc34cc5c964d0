// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/battery_watch.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace rosflight::autonomy {

config::Table<BatteryConfig> battery_table() {
  using B = BatteryConfig;
  using config::Range;
  const auto charge = Range::between(0.0, 1.0);
  const auto volt = Range::between(0.0, 5.0);
  return {{"warn_cell_V", &B::warn_cell_V, "V", volt, "of a cell at rest: warns below"},
          {"return_cell_V", &B::return_cell_V, "V", volt, "returns below"},
          {"land_cell_V", &B::land_cell_V, "V", volt, "lands below"},
          {"warn_charge", &B::warn_charge, "", charge, "share of the capacity: warns below"},
          {"return_charge", &B::return_charge, "", charge, "returns below"},
          {"land_charge", &B::land_charge, "", charge, "lands below"},
          {"confirm_s", &B::confirm_s, "s", Range::between(0.0, 60.0),
           "a level counts after this time"}};
}

std::optional<double> cell_at_rest_V(const BatteryConfig& config,
                                     const BatteryWatch::Sample& sample) {
  if (!(config.cells > 0.0) || !sample.fresh || !(sample.voltage_V > 0.0)) return {};
  return (sample.voltage_V + config.resistance_ohm * sample.current_A) / config.cells;
}

std::string takeoff_fault(const BatteryConfig& config, const BatteryWatch::Sample& sample) {
  const std::optional<double> cell_V = cell_at_rest_V(config, sample);
  const double min_V = std::max(config.return_cell_V, config.land_cell_V);
  if (!cell_V || (*cell_V >= min_V && *cell_V <= kMaxCell_V)) return "";
  std::array<char, 200> text{};
  std::snprintf(
      text.data(), text.size(),
      "battery: found %.1f V, %.2f V in each of the %g cells of the vehicle file, allowed "
      "%.2f to %.2f V: %sbattery.cells must be those of the pack",
      sample.voltage_V, *cell_V, config.cells, min_V, kMaxCell_V,
      *cell_V < min_V ? "charge it; " : "");
  return text.data();
}

double BatteryWatch::charge() const {
  if (!(config_.capacity_Ah > 0.0)) return 1.0;
  constexpr double kSecondsPerHour = 3600.0;
  return std::max(1.0 - taken_As_ / (config_.capacity_Ah * kSecondsPerHour), 0.0);
}

BatteryLevel BatteryWatch::by_voltage(const Sample& sample) const {
  const std::optional<double> cell_V = cell_at_rest_V(config_, sample);
  if (!cell_V) return BatteryLevel::kGood;
  if (*cell_V < config_.land_cell_V) return BatteryLevel::kLand;
  if (*cell_V < config_.return_cell_V) return BatteryLevel::kReturn;
  return *cell_V < config_.warn_cell_V ? BatteryLevel::kWarn : BatteryLevel::kGood;
}

BatteryLevel BatteryWatch::by_charge() const {
  const double left = charge();
  if (!(config_.capacity_Ah > 0.0)) return BatteryLevel::kGood;
  if (left < config_.land_charge) return BatteryLevel::kLand;
  if (left < config_.return_charge) return BatteryLevel::kReturn;
  return left < config_.warn_charge ? BatteryLevel::kWarn : BatteryLevel::kGood;
}

BatteryLevel BatteryWatch::step(const Sample& sample, double dt_s) {
  if (sample.fresh) current_A_ = sample.current_A;
  if (dt_s > 0.0) taken_As_ += std::max(current_A_, 0.0) * dt_s;
  const BatteryLevel now = std::max(by_voltage(sample), by_charge());
  worse_s_ = now > level_ ? worse_s_ + dt_s : 0.0;
  if (now > level_ && worse_s_ >= config_.confirm_s) {
    level_ = now;
    worse_s_ = 0.0;
  }
  return level_;
}

}  // namespace rosflight::autonomy
