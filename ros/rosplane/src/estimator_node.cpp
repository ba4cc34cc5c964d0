// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/estimator_node.hpp"
#include "rosflight_common/component.hpp"

#include "rosplane/conversions.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace {

using autonomy::estimation::EstimatorConfig;
using rosflight_common::kPascalPerMetre;

/// One parameter over one number of the configuration, `unit` parameters to one of ours.
rosflight_common::EstimatorView view(const char* name, double min, double max, const char* text,
                                     double (*get)(const EstimatorConfig&),
                                     void (*set)(EstimatorConfig&, double)) {
  return {name, min, max, text, get, set};
}

struct Policy {
  static constexpr auto kAirframe = autonomy::estimation::Airframe::kFixedWing;
  static constexpr const char* kVehicle = kUsualVehicle;
  using Message = rosplane_msgs::msg::State;

  static void fill(const autonomy::StateEstimate& in,
                   const std::optional<autonomy::Geodetic>& origin, Message& out) {
    put(in, origin, out);
  }

  /// A fixed wing flies without a position as well: the position is sent as NaN.
  static bool worth_telling(const autonomy::StateEstimate& in) {
    using autonomy::Quality;
    return in.attitude != Quality::kNone && in.heading != Quality::kNone &&
           in.vertical != Quality::kNone;
  }

  static std::vector<rosflight_common::EstimatorView> views() {
    using C = EstimatorConfig;
    return {
        view(
            "gravity", 9.0, 10.0, "gravity [m/s^2]", [](const C& c) { return c.gravity_m_s2; },
            [](C& c, double x) { c.gravity_m_s2 = x; }),
        view(
            "sigma_n_gps", 1e-3, 100.0,
            "standard deviation of the GNSS position, north and east [m]",
            [](const C& c) { return c.gnss_horizontal_sigma_m; },
            [](C& c, double x) { c.gnss_horizontal_sigma_m = x; }),
        view(
            "sigma_h_gps", 1e-3, 100.0, "standard deviation of the GNSS altitude [m]",
            [](const C& c) { return c.gnss_altitude_sigma_m; },
            [](C& c, double x) { c.gnss_altitude_sigma_m = x; }),
        view(
            "sigma_vn_gps", 1e-3, 100.0, "standard deviation of the GNSS velocity, each axis [m/s]",
            [](const C& c) { return c.gnss_velocity_sigma_m_s; },
            [](C& c, double x) { c.gnss_velocity_sigma_m_s = x; }),
        view(
            "sigma_static_press", 0.01, 1000.0, "standard deviation of the barometer [Pa]",
            [](const C& c) { return kPascalPerMetre * c.baro_sigma_m; },
            [](C& c, double x) { c.baro_sigma_m = x / kPascalPerMetre; }),
        view(
            "sigma_diff", 0.01, 1000.0, "standard deviation of the pitot tube [Pa]",
            [](const C& c) { return c.pitot_sigma_Pa; },
            [](C& c, double x) { c.pitot_sigma_Pa = x; }),
        view(
            "sigma_beta", 1e-3, 100.0, "standard deviation of the sideslip, as a speed [m/s]",
            [](const C& c) { return c.sideslip_sigma_m_s; },
            [](C& c, double x) { c.sideslip_sigma_m_s = x; }),
        view(
            "min_airspeed_estimation", 0.1, 100.0,
            "minimum airspeed at which pitot tube and sideslip are used [m/s]",
            [](const C& c) { return c.min_airspeed_m_s; },
            [](C& c, double x) { c.min_airspeed_m_s = x; }),
        rosflight_common::declination_view(),
    };
  }
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosflight_common::EstimatorNode<rosplane::Policy>, SingleThreadedExecutor)
