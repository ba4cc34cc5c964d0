// SPDX-License-Identifier: BSD-3-Clause
// The default quadrotor near hover, stepped N times by 2.5 ms: what a step of the physics costs.
// Run it under callgrind with two lengths and take the difference, or time it.
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/registry.hpp"

namespace {

bool parse(const char* text, std::int64_t& value) {
  const char* end = text + std::strlen(text);
  return std::from_chars(text, end, value).ptr == end && value >= 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace rosflight;
  std::int64_t steps = 0;
  if (argc != 4 || std::string(argv[1]) != "--steps" || !parse(argv[2], steps)) {
    std::fputs("usage: physics_step --steps N VEHICLE.yaml\n", stderr);
    return 2;
  }
  try {
    sim::Registry registry;
    sim::register_physics(registry);
    const sim::Vehicle vehicle = sim::Vehicle::from_file(argv[3]);
    const sim::RandomSource random{1};
    const auto forces = registry.make_forces(vehicle, random);
    sim::RigidBody dynamics(vehicle.body(), vehicle.ground(), vehicle.environment(), *forces,
                            random);
    sim::BodyState start;
    start.p_W.z() = -50.0;
    dynamics.set_state(start);
    hal::OutputValues outputs{};
    for (std::int64_t i = 1; i <= steps; ++i) {
      // Holds height well enough: more when below or falling.
      const sim::BodyState& body = dynamics.truth().body;
      const double duty = 0.49 + 0.02 * (body.p_W.z() + 50.0) - 0.05 * -body.v_B.z();
      outputs.fill(static_cast<float>(duty));
      dynamics.step(hal::microseconds(2500 * i), outputs);
    }
    std::cout << nlohmann::json{{"height_m", -dynamics.truth().body.p_W.z()}} << "\n";
  } catch (const config::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
