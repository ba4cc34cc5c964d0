// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "config/table.hpp"

namespace rosflight::autonomy {

/// What the battery can still do, in the order of urgency.
enum class BatteryLevel : std::uint8_t {
  kGood,
  kWarn,    ///< Say so.
  kReturn,  ///< Enough to go back.
  kLand     ///< Land now.
};

/// The pack, and the levels. Cells and capacity come from the vehicle file's section `battery`.
struct BatteryConfig {
  double cells{};           ///< In series; 0: voltages are not judged.
  double capacity_Ah{};     ///< 0: the charge is not judged.
  double resistance_ohm{};  ///< Resistance of the whole pack.
  double warn_cell_V{3.75};
  double return_cell_V{3.72};
  double land_cell_V{3.63};
  double warn_charge{0.25};  ///< Share of the capacity that is left.
  double return_charge{0.18};
  double land_charge{0.08};
  double confirm_s{3.0};  ///< A level counts after this time.
};

/// The keys of the section `autonomy.battery`.
config::Table<BatteryConfig> battery_table();

/// Judges a battery by the voltage of its cells at rest and by the charge taken from it:
///
///     U0 = (V + R I)/cells        left = 1 - (integral of I dt)/capacity                     (1)
///
/// The worse of the two decides. A level is reached when it has lasted confirm_s; a battery does not
/// recover in flight, so a level never falls back. Without new samples nothing changes but the
/// charge, which goes on at the last current. Counting begins with a full battery; one that is not
/// shows in its voltage.
class BatteryWatch {
 public:
  BatteryWatch() = default;
  explicit BatteryWatch(const BatteryConfig& config) : config_(config) {}

  struct Sample {
    double voltage_V{};  ///< At the terminals; <= 0: unknown.
    double current_A{};
    bool fresh{};  ///< Measured lately.
  };
  /// Also in flight; what was taken and the level stay.
  void configure(const BatteryConfig& config) { config_ = config; }
  /// Once a step, while armed. Fast: some twenty operations.
  BatteryLevel step(const Sample& sample, double dt_s);

  BatteryLevel level() const { return level_; }
  /// Share of the capacity that is left, by (1); 1 where it is not judged.
  double charge() const;

 private:
  BatteryLevel by_voltage(const Sample& sample) const;
  BatteryLevel by_charge() const;

  BatteryConfig config_{};
  BatteryLevel level_{BatteryLevel::kGood};
  double taken_As_{};
  double current_A_{};
  double worse_s_{};  ///< How long the next level has lasted.
};

/// The voltage of one cell at rest, U0 of (1); absent where the cells or a fresh voltage are not known.
std::optional<double> cell_at_rest_V(const BatteryConfig& config,
                                     const BatteryWatch::Sample& sample);

/// A full lithium cell has 4.35 V at most; the rest is what a voltage divider may be wrong by.
inline constexpr double kMaxCell_V = 4.4;

/// Why a flight must not begin with this battery, in one line; empty if it may, or if its voltage is not known.
///
/// Below the levels that return or land the flight would end as soon as it has begun: the battery is empty, or the pack has fewer
/// cells than `cells`. Above kMaxCell_V it has more, and no level would ever be reached.
std::string takeoff_fault(const BatteryConfig& config, const BatteryWatch::Sample& sample);

}  // namespace rosflight::autonomy
