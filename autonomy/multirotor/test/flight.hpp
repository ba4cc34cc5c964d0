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
      plant.step(silent ? pilot() : manager.output().command, armed(), kWorldStep_s);
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
            .battery_fresh = battery_V > 0.0,
            .silent_s = silent ? t_s - heard_s_ : 0.0};
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
  bool silent{false};                ///< Nothing arrives, either way; the pilot keeps the height.
  bool with_baro{false};
  bool with_accel{false};
  bool with_range{false};
  double accel_bias_m_s2{0.0};
  double t_s{};
  double last_step_s{};
  bool disarmed{false};
  double impact_m_s{};  ///< Speed at the last touch of the ground.
  std::vector<FlightEvent> events;

 private:
  static constexpr double kWorldStep_s = 1e-3;

  void control(const std::function<void()>& after_step) {
    last_step_s = t_s;
    if (!silent) {
      heard_s_ = t_s;
      seen_ = plant.state();
    } else if (t_s - heard_s_ > GapWatch::kSilent_s) {
      seen_.p_W.setConstant(std::nan(""));
    }
    if (look && !silent) look(seen_);
    const FlightOutput& out = manager.step(
        {.t_s = t_s, .state = seen_, .status = status(), .range_m = range(), .raw = raw()});
    events.insert(events.end(), out.events.begin(), out.events.end());
    if (out.tracking) {
      square_sum_ += (out.setpoint.p_W - plant.state().p_W).squaredNorm();
      ++samples_;
    }
    if (out.request_disarm) disarmed = true;
    after_step();
  }

  FirmwareCommand pilot() const {
    FirmwareCommand out;
    out.mode = FirmwareMode::kRollPitchYawrateThrottle;
    const double weight_N = manager.config().controller.mass_kg * plant.config().gravity_m_s2;
    const double thrust_N = weight_N * (1.0 + 0.3 * plant.state().v_W.z());
    out.u[2] = static_cast<float>(manager.config().thrust.throttle(thrust_N));
    return out;
  }
  std::optional<double> range() const {
    constexpr double kMax_m = 8.0;
    const double up_m = plant.config().ground_down_m - plant.state().p_W.z();
    return with_range && !silent && up_m < kMax_m ? std::optional(up_m) : std::nullopt;
  }
  RawMotion raw() const {
    RawMotion out;
    if (silent) return out;
    if (with_baro) out.baro_up_m = 120.0 - plant.state().p_W.z();
    if (with_accel) {
      out.q_WB = plant.state().q_WB;
      out.w_B = plant.state().w_B;
      out.a_B = plant.specific_B() + Vector3(0.0, 0.0, accel_bias_m_s2);
    }
    return out;
  }

  State seen_;
  double heard_s_{};
  long tick_{};
  long samples_{};
  double square_sum_{};
};

}  // namespace rosflight::autonomy::multirotor::test
