// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/flight_events.hpp"
#include "autonomy/common/gap_watch.hpp"
#include "autonomy/multirotor/controller.hpp"
#include "autonomy/multirotor/state_machine.hpp"
#include "autonomy/multirotor/thrust_watch.hpp"

namespace rosflight::autonomy::multirotor {

/// Flies a multirotor by received ControllerCommands, from take-off to landing:
///
///     received command -> [state machine] -> controller -> firmware command
///
/// begin() selects the source of the command; finish() computes the firmware command. FlightManager
/// passes the commands of its own follower, the ROS controller those it receives.
///
/// The flight starts when the vehicle is armed, the pilot holds no axis and the caller is ready. A
/// state that is not finite, or a link that is silent (GapWatch): the last command is repeated for
/// kStateGrace_s, then all channels are ignored, which hands the vehicle to the pilot. Without a horizontal position (State) it keeps
/// level; its caller gives no command then. While the flight controller flies its failsafe command
/// the hold point follows the vehicle, as for a pilot. A vehicle that does not follow its thrust
/// (ThrustWatch) lands, with the limits of thrust and acceleration downwards lifted. It allocates
/// nothing.
class CommandedFlight {
 public:
  static constexpr double kStateGrace_s = 0.1;

  enum class Turn : std::uint8_t {
    kNone,   ///< Time stood still, or no state to fly on: output() holds.
    kIdle,   ///< Motors idle; output() is complete.
    kOwn,    ///< finish() with the state machine's command: take-off, hold, landing.
    kFollow  ///< finish() with the received command, if it is good.
  };
  struct Input {
    double t_s{};  ///< Must grow.
    const State& state;
    const Status& status;
    bool ready{true};             ///< The caller wants to fly.
    bool command_good{true};      ///< The received command may be flown.
    const Trajectory* planned{};  ///< Where the vehicle is meant to be; may be null.
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    std::optional<double> range_m{};  ///< Downward range, if fresh and in range.
  };
  struct Output {
    FirmwareCommand command{};
    Phase phase{Phase::kDisarmed};
    Phase before{Phase::kDisarmed};  ///< Phase of the step before.
    Trajectory setpoint{};           ///< What the state machine holds or moves along.
    double roll_rad{};               ///< Commanded.
    double pitch_rad{};
    double yaw_rate_rad_s{};
    double thrust_N{};
    bool tracking{};  ///< The received command is flown, and we hold all axes.
    bool landed{};    ///< Once in this flight.
    bool request_disarm{};
    FlightEvents events{};
  };

  CommandedFlight() = default;
  /// On the ground until renew() has given the machine its settings.
  CommandedFlight(const ControllerConfig& config, const ThrustModel& thrust)
      : config_(config), controller_(config, thrust) {}

  /// Checks the state, steps the state machine and selects the source of the command. Once a step;
  /// a time not after the last gives kNone.
  Turn begin(const Input& in);
  /// @param command  the received one, for kFollow; not used for kOwn.
  void finish(const State& state, const ControllerCommand& command);

  /// No state will come: as one that is not finite, but at once.
  void lose_state();
  /// Land where it is; cannot be taken back.
  void request_land() { land_ = true; }
  /// Forgets a landing, asked for or done. The machine too, if it is on the ground.
  void renew(const StateMachineConfig& states);

  bool started() const { return started_; }
  bool state_lost() const { return state_lost_; }
  bool on_ground() const;
  /// Same as StateMachine::command_good.
  bool command_good(const ControllerCommand& command, double age_s) const {
    return machine_.command_good(command, age_s);
  }
  /// As Controller::trim_W, for a follower that takes over.
  Vector3 trim_W() const { return controller_.trim_W(); }
  /// As Controller::enter, with the trim of a follower that hands over [m/s^2].
  void take_over(const Vector3& trim_W) { controller_.enter(step_.command.mode, trim_W); }
  /// Gains and limits change, integrals and filters stay.
  void configure(const ControllerConfig& config, const StateMachineConfig& states) {
    config_ = config;
    apply_config();
    machine_.configure(states);
  }
  /// Another motor model: what the flight controller does with a throttle has changed.
  void set_thrust_model(const ThrustModel& thrust) {
    controller_.configure(controller_.config(), thrust);
  }
  const StateMachine& machine() const { return machine_; }
  const AttitudeView& attitude() const { return attitude_; }  ///< In this step.
  const PilotOverride& pilot() const { return pilot_; }
  double dt_s() const { return dt_s_; }
  const Output& output() const { return out_; }

 private:
  bool check_state(const Input& in);
  void note(bool changed);
  void apply_config();

  ControllerConfig config_{};
  ThrustWatch thrust_watch_;
  Controller controller_;
  StateMachine machine_;
  StateMachine::Output step_{};
  Output out_{};
  AttitudeView attitude_{Quaternion::Identity()};
  OverrideWatch override_;
  PilotOverride pilot_{};
  double dt_s_{};
  double voltage_V_{};
  bool failsafe_{false};
  bool by_failsafe_{false};  ///< What keeps the vehicle from us is, or was, the failsafe command.
  double last_t_s_{};
  double last_good_s_{};
  bool started_{false};
  bool state_lost_{false};
  bool pilot_had_it_{false};
  bool land_{false};
};

}  // namespace rosflight::autonomy::multirotor
