// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "autonomy/multirotor/config.hpp"

/// Any bytes as the section `autonomy` of a vehicle file: refused with one line, or a configuration
/// that can fly a mission.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rosflight;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const autonomy::multirotor::RotorData rotors{.count = 4,
                                               .thrust_coefficient = 0.087,
                                               .torque_coefficient = 0.0043,
                                               .diameter_m = 0.381,
                                               .motor_constant = 0.0289,
                                               .resistance_ohm = 0.042,
                                               .no_load_current_A = 1.5,
                                               .supply_voltage_V = 24.0};
  const autonomy::multirotor::VehicleFacts vehicle{3.5, 9.81, rotors, {0.7, 0.0}};
  try {
    const auto document = config::Document::from_text(text, "fuzz");
    const autonomy::multirotor::FlightConfig config =
        autonomy::multirotor::read_autonomy(document.root(), vehicle).flight;
    autonomy::multirotor::Mission mission;
    mission.waypoints.push_back({.p_W = {3.0, -2.0, -4.0}, .psi_rad = 1.0});
    autonomy::multirotor::FlightManager manager(config, mission);
    autonomy::multirotor::State state;
    for (int k = 0; k < 20; ++k) {
      state.p_W.z() = -0.2 * k;
      const auto& out = manager.step({0.1 * k, state, {.armed = true, .offboard = true}});
      for (const float u : out.command.u) {
        if (!(u > -1e6F && u < 1e6F)) std::abort();
      }
    }
  } catch (const config::Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
