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
        if (!silent) {
          heard_s_ = plant.time_s();
          seen_ = plant.state();
        } else if (plant.time_s() - heard_s_ > GapWatch::kSilent_s) {
          seen_.p_W.setConstant(std::nan(""));
        }
        status.silent_s = plant.time_s() - heard_s_;
        if (look && !silent) look(seen_);
        const auto& out = manager.step({.t_s = plant.time_s(),
                                        .state = seen_,
                                        .status = status,
                                        .range_m = range(),
                                        .raw = raw()});
        events.insert(events.end(), out.events.begin(), out.events.end());
        const auto& u = out.command.u;
        if (out.command.ignore == 0 && !silent) {
          surfaces = {static_cast<double>(u[3]), static_cast<double>(u[4]),
                      static_cast<double>(u[5]), static_cast<double>(u[0])};
        } else if (angle_hold) {
          const bool throttle_ours = !silent && (out.command.ignore & 1U) == 0;
          surfaces = level(throttle_ours ? static_cast<double>(u[0]) : 0.5);
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
  bool silent{false};  ///< Nothing arrives, either way.
  bool angle_hold{
      false};  ///< What is ignored the flight controller holds level, as with FW_ANGLE_HOLD.
  bool with_attitude{false};
  bool with_baro{false};
  std::function<void(StateEstimate&)> look;  ///< Spoils what the manager sees.
  std::vector<FlightEvent> events;

 private:
  static constexpr double kStep_s = 0.0025;
  /// Angles of the sticks, centred; the throttle at cruise.
  Surfaces level(double throttle) const {
    const RollPitch at = RollPitch::of(plant.state().q_WB);
    const Vector3& w = plant.state().w_B;
    return {std::clamp(-1.1 * at.roll_rad - 0.06 * w.x(), -1.0, 1.0),
            std::clamp(-0.06 - 1.8 * at.pitch_rad - 0.15 * w.y(), -1.0, 1.0), 0.0, throttle};
  }
  RawMotion raw() const {
    RawMotion out;
    if (silent) return out;
    if (with_attitude) {
      out.q_WB = plant.state().q_WB;
      out.w_B = plant.state().w_B;
      out.a_B = plant.state().a_B;
    }
    if (with_baro) out.baro_up_m = 300.0 - plant.state().p_W.z();
    return out;
  }
  std::optional<double> range() const {
    const double up_m = -plant.state().p_W.z();
    return with_range && !silent && up_m < 8.0 ? std::optional(std::max(up_m, 0.0)) : std::nullopt;
  }
  StateEstimate seen_;
  double heard_s_{};
  long tick_{};
};

}  // namespace rosflight::autonomy::fixedwing::test
