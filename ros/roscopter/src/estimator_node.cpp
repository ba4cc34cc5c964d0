// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/estimator_node.hpp"
#include "rosflight_common/component.hpp"

#include <algorithm>

#include "roscopter/conversions.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;
namespace {

using autonomy::estimation::EstimatorConfig;
using rosflight_common::kPascalPerMetre;

/// North and east have one sigma here, the velocities too: docs/autonomy/roscopter.md
struct Policy {
  static constexpr auto kAirframe = autonomy::estimation::Airframe::kMultirotor;
  static constexpr const char* kVehicle = kUsualVehicle;
  using Message = roscopter_msgs::msg::State;

  static void fill(const autonomy::StateEstimate& in,
                   const std::optional<autonomy::Geodetic>& origin, Message& out) {
    roscopter::fill(in, origin, out);
  }

  static std::vector<rosflight_common::EstimatorView> views() {
    using C = EstimatorConfig;
    return {
        {"gravity", 9.0, 10.0, "gravity [m/s^2]", [](const C& c) { return c.gravity_m_s2; },
         [](C& c, double x) { c.gravity_m_s2 = x; }},
        {"sigma_n_gps", 1e-3, 100.0, "standard deviation of the GNSS position, north and east [m]",
         [](const C& c) { return c.gnss_horizontal_sigma_m; },
         [](C& c, double x) { c.gnss_horizontal_sigma_m = x; }},
        {"sigma_h_gps", 1e-3, 100.0, "standard deviation of the GNSS altitude [m]",
         [](const C& c) { return c.gnss_altitude_sigma_m; },
         [](C& c, double x) { c.gnss_altitude_sigma_m = x; }},
        {"sigma_vn_gps", 1e-3, 100.0, "standard deviation of the GNSS velocity, each axis [m/s]",
         [](const C& c) { return c.gnss_velocity_sigma_m_s; },
         [](C& c, double x) { c.gnss_velocity_sigma_m_s = x; }},
        {"sigma_static_press", 0.01, 1000.0, "standard deviation of the barometer [Pa]",
         [](const C& c) { return kPascalPerMetre * c.baro_sigma_m; },
         [](C& c, double x) { c.baro_sigma_m = x / kPascalPerMetre; }},
        rosflight_common::declination_view(),
    };
  }
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(rosflight_common::EstimatorNode<roscopter::Policy>, SingleThreadedExecutor)
