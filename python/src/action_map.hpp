// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "autonomy/common/state_estimate.hpp"
#include "companion/offboard.hpp"
#include "firmware/core/firmware.hpp"
#include "flight/flight_setup.hpp"
#include "link/messages.hpp"
#include "python/src/companion_loops.hpp"

namespace rosflight::python {

using Action = std::array<float, kActions>;

/// What the four numbers of an action are, each -1 to 1.
enum class ActionLevel : std::uint8_t {
  kMotors,  ///< Outputs of motors 0 to 3, -1: off, 1: full; through pass-through and the inverse of the mixer.
  kSurfaces,  ///< Throttle (0: cruise), aileron, elevator, rudder; through pass-through.
  kRates,  ///< Throttle (0: what hovers), roll, pitch and yaw rate over the firmware's limits of the sticks.
  kAngles,    ///< Throttle, roll, pitch, and yaw rate likewise.
  kVelocity,  ///< A velocity over the limits of the vehicle's autonomy, by CompanionLoops.
  kWaypoint  ///< A point as seen from where the vehicle is when the action begins, by CompanionLoops.
};

/// Actions as the commands that a companion of this vehicle sends.
class ActionMap {
 public:
  /// @throws config::Error  the level is unknown, or this vehicle does not have it.
  ActionMap(const flight::FlightSetup& setup, const std::string& level);
  /// With the mixer that the firmware computed; once it runs.
  void read_mixer(const core::Firmware& firmware);

  /// The loops of velocity and position begin without integrals.
  void restart();
  /// An action begins. @param state  as the companion knows it.
  void begin(const Action& action, const autonomy::StateEstimate& state);
  /// The command at `state`, dt_s after the one before. Only velocity and position depend on the state.
  link::OffboardControl command(const autonomy::StateEstimate& state, double dt_s,
                                double battery_voltage_V);
  bool depends_on_state() const { return loops_ != nullptr; }

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
      inverse_{};                          ///< Inputs of the mixer by outputs of motors.
  std::unique_ptr<CompanionLoops> loops_;  ///< For velocity and waypoint; else none.
  Action action_{};
};

/// A command of the companion as a message.
link::OffboardControl sent(const autonomy::FirmwareCommand& command);

}  // namespace rosflight::python
