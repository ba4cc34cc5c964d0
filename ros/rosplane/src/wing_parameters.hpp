// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "autonomy/fixedwing/mission.hpp"
#include "autonomy/fixedwing/zones.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "ros/common/live_parameters.hpp"
#include "ros/common/vehicle_file.hpp"

namespace rosflight::ros_plane {

/// What the nodes of rosplane are configured by: the vehicle file, and on top of it parameters with
/// the names of ROSflight 2.x (docs/autonomy/rosplane.md). Each node declares those it uses.
struct WingConfig {
  autonomy::fixedwing::FlightConfig flight;
  autonomy::fixedwing::MissionLimits limits;
  autonomy::fixedwing::ZoneConfig zones{};
  double min_airspeed_known_m_s{};  ///< Of the estimator: below, the airspeed is not known.
  double rate_Hz{100.0};
  double max_takeoff_throttle{1.0};
  bool roll_override{false};
  bool pitch_override{false};
  bool orbit_last{false};
  double default_height_m{50.0};

  /// @throws config::Error  one line: no vehicle file, a wrong key, another kind of vehicle.
  static WingConfig declare(rclcpp::Node& node) {
    const sim::Vehicle vehicle = ros_common::VehicleFile::declare(node).read();
    if (!flight::is_fixed_wing(vehicle)) {
      throw config::Error("parameter vehicle_file: found a vehicle of type " + vehicle.type() +
                          ", allowed fixedwing");
    }
    const auto autonomy = flight::read_fixedwing_autonomy(vehicle);
    WingConfig out;
    out.flight = autonomy.flight;
    out.limits = autonomy.mission;
    out.min_airspeed_known_m_s = flight::read_estimator(vehicle).min_airspeed_m_s;
    return out;
  }
};

using WingParameter = ros_common::LiveParameter<WingConfig>;
using WingParameters = ros_common::LiveParameters<WingConfig>;

/// A number at `of(config)`, `unit` of ours to one of the parameter's.
template <class Of>
WingParameter over(std::string name, double least, double most, std::string text, Of of,
                   double unit = 1.0) {
  return {std::move(name),
          least,
          most,
          std::move(text),
          [of, unit](const WingConfig& c) { return of(c) / unit; },
          [of, unit](WingConfig& c, double x) { of(c) = x * unit; }};
}

/// A switch at `of(config)`.
template <class Of>
WingParameter flag(std::string name, std::string text, Of of) {
  return {std::move(name),
          0.0,
          1.0,
          std::move(text),
          [of](const WingConfig& c) { return of(c) ? 1.0 : 0.0; },
          [of](WingConfig& c, double x) { of(c) = x != 0.0; },
          true};
}

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

}  // namespace rosflight::ros_plane
