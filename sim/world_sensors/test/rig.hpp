// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "sim/world_sensors/world_sensors.hpp"

/// What the tests of the sensors of the world share.
namespace rosflight::sim::testing {

inline constexpr Time kStep{2500};
/// Bounds are this many standard deviations of the estimate, as in sim/test/noise_test.cpp.
inline constexpr double kSigmas = 4.0;

/// A site for an instrument that is made without a vehicle file.
struct Site {
  config::Document document{config::Document::from_text("{}", "test")};
  config::Section section{document.root()};
  world::WorldShapes shapes;
  RandomSource random{7};
  WorldSensorSite site{section, "test", shapes, random, Vector3::Zero(), kStep};
};

/// At a place of the world, turned by an angle [rad] about an axis of the body.
inline Truth at(const Vector3& p_W, double angle = 0.0, const Vector3& axis = Vector3::UnitZ(),
                Time t = Time{0}) {
  Truth truth;
  truth.time = t;
  truth.body.p_W = p_W;
  truth.body.q_WB = Quaternion(Eigen::AngleAxisd(angle, axis));
  return truth;
}

/// The default multirotor with this section world_sensors.
inline Vehicle vehicle_with(const std::string& world_sensors) {
  return Vehicle::from_file("vehicles/multirotor.yaml", {"world_sensors=" + world_sensors});
}

}  // namespace rosflight::sim::testing
