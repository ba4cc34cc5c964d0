// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <functional>
#include <vector>

#include "autonomy/multirotor/config.hpp"
#include "autonomy/multirotor/test/plant.hpp"

namespace rosflight::autonomy::multirotor::test {

/// The shipped configuration of the default quadrotor.
inline FlightConfig default_config(double rc_max_thr = 0.7, double firmware_max_thrust_N = 0.0) {
  const VehicleFacts vehicle{3.5, 9.81, default_rotors(), {rc_max_thr, firmware_max_thrust_N}};
  const auto document = config::Document::from_file("vehicles/multirotor.yaml");
  return read_autonomy(document.root().section("autonomy"), vehicle).flight;
}

/// A flight manager in the small world of plant.hpp, armed half a second after the start.
class Flight {
 public:
  explicit Flight(const FlightConfig& config = default_config(),
                  const std::filesystem::path& file = "missions/default.yaml",
                  const PlantConfig& world = {})
      : mission(load_mission(file, {})), manager(config, mission), plant(world, config.thrust) {}

  void run(double seconds, const std::function<void()>& after_step = [] {}) {
    const long steps = std::lround(seconds / kWorldStep_s);
    for (long k = 0; k < steps && !disarmed; ++k) {
      if (tick_++ % (1000 / rate_hz) == 0) control(after_step);
      plant.step(manager.output().command, armed(), kWorldStep_s);
      t_s += kWorldStep_s;
      if (plant.state().p_W.z() < plant.config().ground_down_m - 0.5) plant.take_impact_m_s();
      impact_m_s = std::max(impact_m_s * (plant.on_ground() ? 1.0 : 0.0), plant.take_impact_m_s());
    }
  }

  const FlightOutput& output() const { return manager.output(); }
  Status status() const {
    return {.armed = armed(),
            .offboard = true,
            .rc_override = override_word,
            .battery_voltage_V = battery_V,
            .failsafe = failsafe,
            .battery_fresh = battery_V > 0.0};
  }
  bool armed() const { return t_s >= 0.5 && !disarmed; }
  std::vector<FlightEvent> events_of(FlightEventType type) const {
    std::vector<FlightEvent> out;
    for (const FlightEvent& event : events) {
      if (event.type == type) out.push_back(event);
    }
    return out;
  }
  double tracking_rms_m() const {
    return std::sqrt(square_sum_ / static_cast<double>(std::max(samples_, 1L)));
  }

  Mission mission;
  FlightManager manager;
  Plant plant;
  int rate_hz{200};
  std::uint16_t override_word{};
  bool failsafe{false};
  double battery_V{0.0};             ///< 0: not measured.
  std::function<void(State&)> look;  ///< Spoils what the manager sees.
  double t_s{};
  double last_step_s{};
  bool disarmed{false};
  double impact_m_s{};  ///< Speed at the last touch of the ground.
  std::vector<FlightEvent> events;

 private:
  static constexpr double kWorldStep_s = 1e-3;

  void control(const std::function<void()>& after_step) {
    last_step_s = t_s;
    State seen = plant.state();
    if (look) look(seen);
    const FlightOutput& out = manager.step({t_s, seen, status()});
    events.insert(events.end(), out.events.begin(), out.events.end());
    if (out.tracking) {
      square_sum_ += (out.setpoint.p_W - plant.state().p_W).squaredNorm();
      ++samples_;
    }
    if (out.request_disarm) disarmed = true;
    after_step();
  }

  long tick_{};
  long samples_{};
  double square_sum_{};
};

}  // namespace rosflight::autonomy::multirotor::test
