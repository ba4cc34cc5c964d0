// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <vector>

#include "autonomy/fixedwing/flight_manager.hpp"
#include "autonomy/fixedwing/test/plant.hpp"

namespace rosflight::autonomy::fixedwing::test {

/// The default tuning, with what it needs to know of the aircraft of plant.hpp.
inline FlightConfig default_config() {
  FlightConfig config;
  Airframe& a = config.controller.airframe;
  a.elevator_trim = -0.135 / (0.99 * 40.0 * kRadPerDeg);
  a.elevator_1_rad = 2.74 / (0.99 * 40.0 * kRadPerDeg);
  return config;
}

/// The hourglass of ROSflight 2.x.
inline Mission hourglass(Passing passing = Passing::kFillet) {
  Mission out;
  const double places[4][2] = {{400, -250}, {-400, -50}, {-400, -250}, {400, -50}};
  for (const auto& place : places) {
    Waypoint wp;
    wp.p_W = {place[0], place[1], -70.0};
    wp.passing = passing;
    wp.course_rad = 1.1518;
    wp.airspeed_m_s = 17.0;
    out.waypoints.push_back(wp);
  }
  return out;
}

/// A flight manager in the small world, standing at the origin with the nose north, armed after
/// half a second.
class SmallWorld {
 public:
  explicit SmallWorld(const Mission& mission, const PlantConfig& world = {},
                      const FlightConfig& config = default_config())
      : manager(config, mission), plant(world) {
    plant.stand(0.0);
  }

  /// Runs for a time or until the flight asks to be disarmed.
  void run(double seconds, const std::function<void()>& after_step = [] {}) {
    const long steps = std::lround(seconds / kStep_s);
    for (long k = 0; k < steps && !manager.output().request_disarm; ++k) {
      if (tick_++ % 4 == 0) {
        status.armed = plant.time_s() > 0.5;
        StateEstimate seen = plant.state();
        if (look) look(seen);
        const auto& out = manager.step({plant.time_s(), seen, status, range()});
        events.insert(events.end(), out.events.begin(), out.events.end());
        if (out.command.ignore == 0) {
          const auto& u = out.command.u;
          surfaces = {static_cast<double>(u[3]), static_cast<double>(u[4]),
                      static_cast<double>(u[5]), static_cast<double>(u[0])};
        }
        after_step();
      }
      plant.step(surfaces, kStep_s);
    }
  }
  bool run_until(Phase phase, double longest_s) {
    const double end_s = plant.time_s() + longest_s;
    while (manager.output().phase != phase && plant.time_s() < end_s &&
           !manager.output().request_disarm) {
      run(0.1);
    }
    return manager.output().phase == phase;
  }
  int count(FlightEventType type) const {
    int n = 0;
    for (const FlightEvent& e : events) n += e.type == type ? 1 : 0;
    return n;
  }
  double height_m() const { return -plant.state().p_W.z(); }

  FlightManager manager;
  Plant plant;
  Status status{};
  Surfaces surfaces{};
  bool with_range{true};
  std::function<void(StateEstimate&)> look;  ///< Spoils what the manager sees.
  std::vector<FlightEvent> events;

 private:
  static constexpr double kStep_s = 0.0025;
  std::optional<double> range() const {
    const double up_m = -plant.state().p_W.z();
    return with_range && up_m < 8.0 ? std::optional(std::max(up_m, 0.0)) : std::nullopt;
  }
  long tick_{};
};

}  // namespace rosflight::autonomy::fixedwing::test
