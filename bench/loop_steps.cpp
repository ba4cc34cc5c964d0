// SPDX-License-Identifier: BSD-3-Clause
// The default flight, stepped N times by 2.5 ms: what a step of the whole loop costs. Run it under callgrind with two
// lengths and take the difference.
//
// usage: loop_steps truth|estimate|unlinked|setup --steps N
//
// truth, estimate: what the companion of the mission flies on. unlinked: hovering without link bytes, as environments of
// Python are by default. setup: N flights of a campaign with conditions of their own are set up, and not flown.
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "companion/offboard.hpp"
#include "flight/flight.hpp"
#include "flight/simulation.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file

double fly(const char* state, std::int64_t steps) {
  flight::FlightChoice choice;
  choice.state = state;
  const auto setup = std::make_unique<flight::FlightSetup>(choice);
  flight::Flight flight(*setup);
  for (std::int64_t i = 0; i < steps; ++i) flight.step();
  return -flight.truth().body.p_W.z();
}

void set_up(std::int64_t flights) {
  for (std::int64_t i = 0; i < flights; ++i) {
    flight::FlightChoice choice;
    choice.seed = static_cast<std::uint64_t>(i);
    choice.wind = std::to_string(i % 8) + ",270";
    choice.overrides = {"body.mass_kg=3." + std::to_string(i % 8)};
    const auto setup = std::make_unique<flight::FlightSetup>(choice);
    const flight::Flight flight(*setup);
  }
}

double hover(std::int64_t steps) {
  constexpr std::int64_t kStepsOfACommand = 4;
  constexpr double kHigh_m = 50.0;
  const auto setup = std::make_unique<flight::FlightSetup>(flight::FlightChoice{});
  flight::Simulation simulation(*setup);
  simulation.start();
  simulation.drop_link();
  sim::BodyState start;
  start.p_W.z() = -kHigh_m;
  simulation.set_state(start);
  for (std::int64_t i = 0; i < steps; ++i) {
    if (i % kStepsOfACommand == 0) {
      // Holds height well enough: more when below or falling.
      const sim::BodyState& body = simulation.truth().body;
      const double more = 0.02 * (body.p_W.z() + kHigh_m) + 0.05 * body.v_B.z();
      simulation.tell(companion::body_rates(0.0F, 0.0F, 0.0F,
                                            static_cast<float>(setup->hover_throttle + more)));
    }
    simulation.step();
  }
  return -simulation.truth().body.p_W.z();
}

bool parse(const char* text, std::int64_t& value) {
  const char* end = text + std::strlen(text);
  return std::from_chars(text, end, value).ptr == end && value >= 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::int64_t steps = 0;
  const std::string kind = argc > 1 ? argv[1] : "";
  const bool known = kind == "truth" || kind == "estimate" || kind == "unlinked" || kind == "setup";
  if (argc != 4 || !known || std::string(argv[2]) != "--steps" || !parse(argv[3], steps)) {
    std::fputs("usage: loop_steps truth|estimate|unlinked|setup --steps N\n", stderr);
    return 2;
  }
  try {
    if (kind == "setup") {
      set_up(steps);
      return 0;
    }
    const double height_m = kind == "unlinked" ? hover(steps) : fly(kind.c_str(), steps);
    std::cout << nlohmann::json{{"height_m", height_m}} << "\n";
  } catch (const std::exception& error) {
    std::fprintf(stderr, "loop_steps: %s\n", error.what());
    return 1;
  }
  return 0;
}
