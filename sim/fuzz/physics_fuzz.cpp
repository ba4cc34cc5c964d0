// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a whole vehicle file: refused with one line, or a vehicle that can be stepped. (It
// need not stay finite: limits of single values do not keep somebody from building a vehicle too
// stiff for the step.)
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sim/registry.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  try {
    const sim::Vehicle vehicle(config::Document::from_text(std::string(data, data + size), "fuzz"));
    sim::Registry registry;
    sim::register_physics(registry);
    const sim::RandomSource random{1};
    const auto forces = registry.make_forces(vehicle, random);
    sim::RigidBody dynamics(vehicle.body(), vehicle.ground(), vehicle.environment(), *forces,
                            random);
    hal::OutputValues outputs{};
    outputs.fill(0.6F);
    for (std::int64_t i = 1; i <= 20; ++i) dynamics.step(hal::microseconds(2500 * i), outputs);
  } catch (const config::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
