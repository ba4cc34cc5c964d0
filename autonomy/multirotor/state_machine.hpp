// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/multirotor/landing.hpp"
#include "autonomy/multirotor/phases.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

struct StateMachineConfig {
  double takeoff_height_m{2.0};  ///< Above where it stands.
  double takeoff_speed_m_s{1.0};
  double takeoff_tolerance_m{0.2};   ///< Take-off ends this much below its height.
  double takeoff_timeout_s{15.0};    ///< Not up by then: land, or stay where it still stands.
  double lift_off_height_m{0.15};    ///< Below it a take-off keeps level.
  double hold_s{1.0};                ///< Stay at least this long before a command is followed,
  double settle_distance_m{0.3};     ///< and until it is this close to the hold point
  double settle_speed_m_s{0.4};      ///< and this slow,
  double settle_timeout_s{6.0};      ///< but at most this much longer than hold_s.
  double command_timeout_s{0.5};     ///< An older command is not valid.
  double lost_command_land_s{30.0};  ///< Hold at most this long without a valid command, then land.
  LandingConfig landing{};
};

/// Decides which command the vehicle follows and where it waits. phases.hpp holds the table of the
/// phases.
///
/// - Take-off climbs takeoff_height_m above the position at which the vehicle stood.
/// - A command that is invalid or too old is never flown. The vehicle holds the position at which
///   the command failed for at least hold_s, and lands if none arrives for lost_command_land_s.
/// - While the pilot overrides any axis the vehicle is in kPositionHold and the hold point follows
///   it; on the ground the take-off is postponed.
/// - A failsafe command of the flight controller that leads to the ground ends the flight: low, and
///   without vertical speed for kGrounded_s, or when it ends.
/// - kLanding ends in kLanded when Landing detects the ground; kLanded requests to be disarmed and
///   ends when the vehicle is.
class StateMachine {
 public:
  struct Input {
    double t_s{};
    double dt_s{};
    const State& state;
    double psi_rad{};
    bool armed{};
    bool pilot{};
    bool ready{};
    bool command_good{};
    bool land{};
    double thrust_N{};  ///< Commanded in the step before.
    const Trajectory*
        planned{};    ///< Where the vehicle is meant to be, for a landing on plan; may be null.
    bool failsafe{};  ///< The flight controller flies its failsafe command.
    bool regained{};  ///< The first state after a gap in which others flew.
    // NOLINTNEXTLINE(readability-redundant-member-init): so that GCC lets callers name members
    std::optional<double> range_m{};  ///< Downward range, if fresh and in range.
  };
  struct Output {
    Phase phase{Phase::kDisarmed};
    bool changed{};
    bool follow{};  ///< Fly the received command; `command` is empty.
    bool idle{};    ///< Motors idle: an all-zero command.
    bool level{};   ///< Still on the ground.
    bool request_disarm{};
    bool takeoff_late{};  ///< This step gave up the take-off.
    ControllerCommand command{};
    Trajectory setpoint{};  ///< What is held, for the log.
  };

  static constexpr double kGrounded_s = 1.5;

  StateMachine() = default;
  /// @param weight_N  first guess of the thrust that hovers.
  StateMachine(const StateMachineConfig& config, double weight_N);

  /// One row of the phase table at most, then the command of the phase. Once a control period.
  Output step(const Input& in);
  /// Heights, speeds and times change; a landing that has begun goes on as it was.
  void configure(const StateMachineConfig& config);
  Phase phase() const { return phase_; }
  const StateMachineConfig& config() const { return config_; }
  /// What the range sensor read before the take-off.
  const std::optional<double>& standing_range_m() const { return standing_range_m_; }
  /// Down coordinate of the position of take-off.
  double ground_down_m() const { return ground_down_m_; }

  /// A finite command of a known mode, not older than the timeout.
  bool command_good(const ControllerCommand& command, double age_s) const;

 private:
  PhaseConditions conditions(const Input& in) const;
  void enter(Phase to, const Input& in);
  void hold_here(const Input& in);
  bool settled(const Input& in) const;
  bool at_ground(const Input& in) const;
  bool low(const Input& in) const;
  void watch_failsafe(const Input& in);
  void watch_gap(const Input& in);
  void fly(const Input& in, Output& out);
  void learn_hover_thrust(const Input& in, bool descending_freely);

  StateMachineConfig config_{};
  Landing landing_;
  Landing::Output landing_step_{};
  Phase phase_{Phase::kDisarmed};
  Vector3 hold_W_{Vector3::Zero()};
  double hold_psi_rad_{};
  double ground_down_m_{};  ///< Down coordinate of the take-off position.
  std::optional<double> standing_range_m_;
  bool failsafe_before_{false};
  bool brought_down_{false};  ///< A gap ended close to the ground: it lands.
  double gap_judged_until_s_{-1.0};
  double grounded_s_{};  ///< Low and without vertical speed under a failsafe command.
  double since_s_{};     ///< Entry of the phase.
  double good_s_{};      ///< Last time with a good command, or of entry.
  double weight_N_{};
  double hover_thrust_N_{};
};

}  // namespace rosflight::autonomy::multirotor
