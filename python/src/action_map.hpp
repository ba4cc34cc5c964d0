// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "autonomy/multirotor/controller.hpp"
#include "companion/offboard.hpp"
#include "firmware/core/firmware.hpp"
#include "flight/flight_setup.hpp"
#include "link/messages.hpp"
#include "python/src/seen_state.hpp"

namespace rosflight::python {

inline constexpr std::size_t kActions = 4;
using Action = std::array<float, kActions>;

/// What the four numbers of an action are, each -1 to 1.
enum class ActionLevel : std::uint8_t {
  kMotors,  ///< Outputs of motors 0 to 3, -1: off, 1: full; through pass-through and the inverse of the mixer.
  kSurfaces,  ///< Throttle (0: cruise), aileron, elevator, rudder; through pass-through.
  kRates,  ///< Throttle (0: what hovers), roll, pitch and yaw rate over the firmware's limits of the sticks.
  kAngles,    ///< Throttle, roll, pitch, and yaw rate likewise.
  kVelocity,  ///< Velocity north, east, down and yaw rate over the limits of the vehicle's autonomy.
  kWaypoint  ///< A point kReach_m north, east, down from where the vehicle is when the action begins, and a heading over 180 degrees.
};

/// Actions as the commands that a companion of this vehicle sends.
class ActionMap {
 public:
  /// Distance of a waypoint at an action of 1, along each axis.
  static constexpr double kReach_m = 5.0;

  /// @throws config::Error  the level is unknown, or this vehicle does not have it.
  ActionMap(const flight::FlightSetup& setup, const std::string& level);
  /// With the mixer that the firmware computed; once it runs.
  void read_mixer(const core::Firmware& firmware);

  /// The loops of velocity and position begin without integrals.
  void restart();
  /// An action begins. @param state  as the companion knows it.
  void begin(const Action& action, const SeenState& state);
  /// The same as an action `waypoint`, for any distance.
  void fly_to(const sim::Vector3& p_W, double heading_rad);
  /// The command at `state`, dt_s after the one before. Only velocity and position depend on the state.
  link::OffboardControl command(const SeenState& state, double dt_s, double battery_voltage_V);
  bool depends_on_state() const {
    return level_ == ActionLevel::kVelocity || level_ == ActionLevel::kWaypoint;
  }

 private:
  float throttle(float action) const;
  float limited_throttle(float action) const;
  link::OffboardControl pass_through() const;

  ActionLevel level_;
  float hover_throttle_;
  float max_throttle_{1.0F};  ///< What the firmware makes of a throttle of 1, for a fixed wing.
  companion::ThrottleAxis axis_;
  std::array<float, 3> scale_{};  ///< Roll, pitch, yaw at 1.
  std::array<std::array<float, kActions>, 6>
      inverse_{};  ///< Inputs of the mixer by outputs of motors.
  autonomy::multirotor::Controller fresh_;
  autonomy::multirotor::Controller controller_;
  Action action_{};
  autonomy::multirotor::ControllerCommand wanted_;
};

}  // namespace rosflight::python
