// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/registry.hpp"

namespace rosflight::sim {
namespace {

const std::string kVehicle = "examples/custom_drag/linear_drag.yaml";

std::string plugin() {
  return CUSTOM_DRAG_BUILT;
}

TEST(CustomDrag, IsFoundByNameOnlyOnceItsLibraryIsLoaded) {
  Registry registry;
  register_physics(registry);
  const Vehicle vehicle = Vehicle::from_file(kVehicle);
  try {
    registry.make_forces(vehicle, RandomSource{1});
    ADD_FAILURE() << "known without its library";
  } catch (const config::Error& error) {
    EXPECT_STREQ(error.what(),
                 "examples/custom_drag/linear_drag.yaml:4: type: found linear_drag, allowed "
                 "fixedwing, multirotor, quadplane");
  }
  registry.load_plugin(plugin());
  EXPECT_NE(registry.make_forces(vehicle, RandomSource{1}), nullptr);
}

TEST(CustomDrag, FallsAtTheSpeedOfItsOwnLaw) {
  Registry registry;
  registry.load_plugin(plugin());
  const Vehicle vehicle = Vehicle::from_file(kVehicle, {"ground.model=none"});
  const auto forces = registry.make_forces(vehicle, RandomSource{1});
  RigidBody dynamics(vehicle.body(), vehicle.ground(), vehicle.environment(), *forces,
                     RandomSource{1});
  for (std::int64_t i = 1; i <= 4000; ++i) dynamics.step(hal::microseconds(2500 * i), {});
  // v = m g/b (1 - exp(-b t/m)) with b = 0.9 N s/m; quadratic drag would end at 28 m/s.
  const double expected = 3.5 * 9.80665 / 0.9 * (1.0 - std::exp(-0.9 * 10.0 / 3.5));
  EXPECT_NEAR(dynamics.truth().body.v_B.z(), expected, 1e-6);
}

TEST(CustomDrag, ItsErrorsCrossTheBorder) {
  Registry registry;
  registry.load_plugin(plugin());
  const Vehicle vehicle = Vehicle::from_file(kVehicle, {"linear_drag.coefficient_N_s_m=[1, 2]"});
  try {
    registry.make_forces(vehicle, RandomSource{1});
    ADD_FAILURE() << "took two coefficients";
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("linear_drag.coefficient_N_s_m: found a list of 2"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace rosflight::sim
