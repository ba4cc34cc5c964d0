// SPDX-License-Identifier: BSD-3-Clause
// Flies a mission with our integrator and with another engine, and prints how the flights differ as a row of
// the table in docs/simulation/README.md.
//
// usage: physics_comparison PHYSICS VEHICLE MISSION [WIND]
#include <fmt/format.h>

#include <iostream>

#include "base/constants.hpp"
#include "flight/jsbsim/physics_comparison.hpp"

namespace {

using rosflight::base::kRadPerDeg;
namespace flight = rosflight::flight;

int run(const std::vector<std::string>& words) {
  if (words.size() < 3 || words.size() > 4) {
    std::cerr << "usage: physics_comparison PHYSICS VEHICLE MISSION [WIND]\n";
    return 2;
  }
  flight::FlightChoice choice;
  choice.vehicle = words[1];
  choice.mission = words[2];
  if (words.size() == 4) choice.wind = words[3];
  const flight::PhysicsComparison c = flight::compare_physics(choice, words[0]);
  std::cout << fmt::format(
      "| {} | {}, {}{} | {:.4f}, {:.4f} | {:.3f}, {:.3f} | {:.4f}, {:.4f} | {:.3f}, {:.3f} |\n",
      words[0], words[1], words[2], words.size() == 4 ? ", wind " + words[3] : "",
      c.position_m.rms(), c.position_m.largest(), c.attitude_rad.rms() / kRadPerDeg,
      c.attitude_rad.largest() / kRadPerDeg, c.tracking_rms_m[0], c.tracking_rms_m[1],
      c.touchdown_speed_m_s[0], c.touchdown_speed_m_s[1]);
  return c.success[0] && c.success[1] ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& e) {
    std::cerr << "physics_comparison: " << e.what() << "\n";
    return 2;
  }
}
