// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "autonomy/common/pid.hpp"
#include "autonomy/multirotor/angles.hpp"
#include "autonomy/multirotor/thrust_model.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

/// Who closes the attitude loops of the thrust modes 9 to 11.
enum class AttitudeLoops : std::uint8_t {
  kFirmware,  ///< The flight controller: angles or rates and a throttle go out (firmware modes 2
              ///< and 1).
  kAutonomy  ///< This controller: force and torques go out (firmware mode 0); needs USE_MOTOR_PARAM
             ///< = 1.
};

struct ControllerConfig {
  double mass_kg{3.5};
  double gravity_m_s2{9.81};
  AttitudeLoops attitude_loops{AttitudeLoops::kFirmware};

  PidGains position_horizontal{1.0, 0.0, 0.0};  ///< m -> m/s.
  PidGains position_vertical{1.2, 0.0, 0.0};
  PidGains velocity_horizontal{2.2, 0.8, 0.0};  ///< m/s -> m/s^2.
  std::optional<PidGains> position_east;        ///< Else as north.
  std::optional<PidGains> velocity_east;
  PidGains velocity_vertical{3.0, 1.0, 0.0};
  PidGains heading_to_rate{2.0, 0.0, 0.0};  ///< rad -> rad/s.
  PidGains roll_to_torque{5.0, 0.0, 0.8};   ///< rad -> N m.
  PidGains pitch_to_torque{5.0, 0.0, 0.8};
  PidGains yaw_to_torque{2.0, 0.002, 1.0};
  PidGains roll_rate_to_torque{0.5, 0.0, 0.0};  ///< rad/s -> N m.
  PidGains pitch_rate_to_torque{0.5, 0.0, 0.0};
  PidGains yaw_rate_to_torque{0.5, 0.0, 0.0};
  double derivative_tau_s{0.05};

  double max_tilt_rad{30.0 * kRadPerDeg};
  double max_roll_pitch_rate_rad_s{180.0 * kRadPerDeg};
  double max_yaw_rate_rad_s{90.0 * kRadPerDeg};
  double max_roll_pitch_torque_Nm{10.0};
  double max_yaw_torque_Nm{2.0};
  double min_thrust_N{7.0};
  double max_thrust_N{65.0};
  double min_throttle{0.0};  ///< Clips of the throttle modes 5 to 7, in the firmware's throttle.
  double max_throttle{1.0};
  double max_horizontal_velocity_m_s{5.0};
  double max_climb_m_s{2.0};
  double max_descend_m_s{1.5};
  double max_descend_acceleration_m_s2{4.9};
};

/// Turns a ControllerCommand of any of the twelve modes into what the flight controller takes.
///
/// A mode runs through the chain below until it is one the firmware has; every number out is
/// clipped.
///
///     0 -> 3 -> 2 -> 6     position to velocity, r = PID(psi)
///     4 -> 3 -> 2 -> 6     the same, down velocity given
///     1 -> 3 -> 2 -> 6     down position to velocity
///     3 -> 2 -> 6          velocity to acceleration
///     2 -> 6               acceleration to attitude: ThrustDirection of a - g e3
///     5 -> 6               heading to yaw rate
///     6, 7                 as they are: firmware modes 2, 1
///     9, 10, 11 -> 8       attitude and rate loops to torques: firmware mode 0
///
/// (ROSflight 2.x, roscopter controller.) With AttitudeLoops::kFirmware the thrust modes take 9 ->
/// 10 and go to firmware modes 2 and 1 with the throttle of the ThrustModel. Thrust in mode 2 is
/// what carries the vehicle at its present tilt, m (g - a_d)/cos(tilt), the cosine never taken
/// below cos(max tilt).
///
/// A change of mode restarts the loops that did not run before and leaves the others alone. The
/// caller makes sure that commands are valid (StateMachine::command_good).
class Controller {
 public:
  struct Input {
    const State& state;
    const AttitudeView& attitude;  ///< Computed from state.q_WB.
    const ControllerCommand& command;
    double dt_s{};          ///< <= 0: the last output is repeated.
    PilotOverride pilot{};  ///< Integrals of the axes the pilot holds are cleared.
    bool on_ground{};       ///< Keep level and do not turn; lateral loops hold their integrals.
    double battery_voltage_V{};  ///< <= 0: nominal.
  };
  struct Output {
    FirmwareCommand command{};
    double roll_rad{};  ///< Or roll rate [rad/s] or torque [N m], as the mode has it.
    double pitch_rad{};
    double yaw_rate_rad_s{};
    double thrust_N{};  ///< Commanded; in throttle modes what the throttle gives.
  };

  Controller() = default;
  /// Takes copies; every loop starts without integral.
  Controller(const ControllerConfig& config, const ThrustModel& thrust);

  /// Firmware command for one period dt_s, by the loops of the command's mode.
  Output step(const Input& in);

  /// Restarts the loops that `mode` needs and the present mode does not; the velocity loops among
  /// them start with the acceleration trim_W. step() does the same when the mode is new to it, with
  /// the trim that the velocity loops had when they last ran.
  void enter(ControlMode mode, const Vector3& trim_W);
  /// Integrals of the velocity loops, as an acceleration.
  Vector3 trim_W() const;
  /// Sets the integrals of all loops to zero; filters stay.
  void clear_integrators();
  /// Gains and limits change, integrals and filters stay.
  void configure(const ControllerConfig& config, const ThrustModel& thrust);
  const ControllerConfig& config() const { return config_; }
  const ThrustModel& thrust_model() const { return thrust_; }

 private:
  enum Loop : std::uint8_t {
    kPosN,
    kPosE,
    kPosD,
    kVelN,
    kVelE,
    kVelD,
    kHeading,
    kRollTorque,
    kPitchTorque,
    kYawTorque,
    kRollRate,
    kPitchRate,
    kYawRate,
    kLoops
  };
  using Four = std::array<double, 4>;

  static unsigned loops_of(ControlMode mode);
  static bool pilot_holds(Loop loop, const PilotOverride& pilot);
  Pid::Integrate integrate(Loop loop, const Input& in) const;
  double run(Loop loop, double desired, double current, const Input& in);
  double run(Loop loop, double desired, double current, double rate, const Input& in);

  Vector3 position_to_velocity(const Four& cmd, bool down_too, const Input& in);
  double heading_to_rate(double psi_rad, const Input& in);
  Vector3 velocity_to_acceleration(const Vector3& v_W, const Input& in);
  Output accelerate(double forward, double right, double down, double yaw_rate, const Input& in);
  Output attitude_thrust(const Four& cmd, const Input& in);
  Output to_firmware(FirmwareMode mode, double x, double y, double z, double throttle,
                     double thrust_N, const Input& in) const;
  Output to_mixer(double qx, double qy, double qz, double thrust_N) const;
  Output torques(ControlMode mode, const Four& cmd, const Input& in);
  Output dispatch(const Input& in);

  ControllerConfig config_{};
  ThrustModel thrust_;
  std::array<Pid, kLoops> pids_{};
  ControlMode mode_{ControlMode::kPassThroughToMixer};
  Output last_{};
  double tan_tilt_{};
  double cos_tilt_{1.0};
  bool speed_limited_{false};  ///< In the step before; so is
  bool tilt_limited_{false};
};

}  // namespace rosflight::autonomy::multirotor
