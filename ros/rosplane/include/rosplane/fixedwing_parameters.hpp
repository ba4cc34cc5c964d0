// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "autonomy/fixedwing/mission.hpp"
#include "autonomy/fixedwing/zones.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "rosflight_common/live_parameters.hpp"
#include "rosflight_common/vehicle_file.hpp"
#include "rosplane/conversions.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace sim = rosflight::sim;
namespace flight = rosflight::flight;

/// What the nodes of rosplane are configured by: the vehicle file, and on top of it parameters with
/// the names of ROSflight 2.x (docs/autonomy/rosplane.md). Each node declares those it uses.
struct FixedWingConfig {
  autonomy::fixedwing::FlightConfig flight;
  autonomy::fixedwing::MissionLimits limits;
  autonomy::fixedwing::ZoneConfig zones{};
  double min_airspeed_known_m_s{};  ///< Below it the estimator reports the airspeed as unknown.
  double rate_Hz{100.0};
  double max_takeoff_throttle{1.0};
  bool roll_override{false};
  bool pitch_override{false};
  bool orbit_last{false};
  double default_height_m{50.0};

  /// @throws config::Error  one line: no vehicle file, a wrong key, another kind of vehicle.
  static FixedWingConfig declare(rclcpp::Node& node) {
    const sim::Vehicle vehicle = rosflight_common::VehicleFile::declare(node, kUsualVehicle).read();
    if (!flight::is_fixed_wing(vehicle)) {
      throw config::Error("parameter vehicle_file: found a vehicle of type " + vehicle.type() +
                          ", allowed fixedwing");
    }
    const auto autonomy = flight::read_fixedwing_autonomy(vehicle);
    FixedWingConfig out;
    out.flight = autonomy.flight;
    out.limits = autonomy.mission;
    out.min_airspeed_known_m_s = flight::read_estimator(vehicle).min_airspeed_m_s;
    return out;
  }
};

using FixedWingRow = config::Row<FixedWingConfig>;
using FixedWingTable = config::Table<FixedWingConfig>;
using FixedWingParameters = rosflight_common::LiveParameters<FixedWingConfig>;

/// Lets through what comes not sooner than a period after what it let through last, but for the
/// jitter of stamps.
class Thinning {
 public:
  bool pass(double t_s, double rate_Hz) {
    constexpr double kAlmost = 0.9;
    const bool back = t_s < last_s_;
    if (!back && t_s - last_s_ < kAlmost / rate_Hz) return false;
    last_s_ = t_s;
    return true;
  }

 private:
  double last_s_{-1e12};
};

}  // namespace rosplane
