// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>

#include "autonomy/multirotor/landing.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy {

enum class Phase : std::uint8_t {
  kDisarmed,  ///< Or armed, but told not to fly.
  kTakeoff,
  kPositionHold,
  kOffboard,  ///< The received command is flown.
  kLanding,
  kLanded  ///< Stands, motors idle, asks to be disarmed.
};
inline constexpr std::size_t kPhases = 6;
const char* name(Phase phase);

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

/// Decides who flies the vehicle and where it waits. One table (transitions()) holds every change
/// of phase: the first row that fits wins; not armed always means kDisarmed.
///
/// - Take-off climbs takeoff_height_m above where it stood, wherever that is.
/// - A command that is not valid, or too old, is never flown: the vehicle holds where it was when
/// the
///   command failed, for at least hold_s, and lands if none comes for lost_command_land_s.
/// - While the pilot holds any axis the vehicle waits in kPositionHold and the hold point goes with
/// it; on
///   the ground the take-off waits.
/// - kLanding ends in kLanded when Landing feels the ground; kLanded asks to be disarmed and ends
/// there.
class StateMachine {
 public:
  enum Condition : std::uint16_t {
    kArmed = 1U << 0U,
    kReady = 1U << 1U,  ///< The caller wants to fly.
    kCommandGood = 1U << 2U,
    kPilot = 1U << 3U,  ///< The pilot holds an axis.
    kLandAsked = 1U << 4U,
    kLiftedOff = 1U << 5U,
    kHeightReached = 1U << 6U,
    kTakeoffLate = 1U << 7U,
    kHoldOver = 1U << 8U,
    kCommandLost = 1U << 9U,  ///< No good command for lost_command_land_s.
    kTouched = 1U << 10U
  };
  struct Transition {
    Phase from;
    std::uint16_t all;   ///< Conditions that must hold.
    std::uint16_t none;  ///< Conditions that must not.
    Phase to;
  };
  static std::span<const Transition> transitions();
  /// The phase after `from` under these conditions.
  static Phase next(Phase from, std::uint16_t conditions);

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
        planned{};  ///< Where the vehicle is meant to be, for a landing on plan; may be null.
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

  StateMachine() = default;
  /// @param weight_N  first guess of the thrust that hovers.
  StateMachine(const StateMachineConfig& config, double weight_N);

  Output step(const Input& in);
  /// Heights, speeds and times change; a landing that has begun goes on as it was.
  void configure(const StateMachineConfig& config);
  Phase phase() const { return phase_; }
  const StateMachineConfig& config() const { return config_; }

  /// A finite command of a known mode, not older than the time-out.
  bool command_good(const ControllerCommand& command, double age_s) const;

 private:
  std::uint16_t conditions(const Input& in) const;
  void enter(Phase to, const Input& in);
  void hold_here(const Input& in);
  bool settled(const Input& in) const;
  void fly(const Input& in, Output& out);
  void learn_hover_thrust(const Input& in, bool descending_freely);

  StateMachineConfig config_{};
  Landing landing_;
  Landing::Output landing_step_{};
  Phase phase_{Phase::kDisarmed};
  Vector3 hold_N_{Vector3::Zero()};
  double hold_psi_rad_{};
  double ground_down_m_{};  ///< Down coordinate of the place of take-off.
  double since_s_{};        ///< Entry of the phase.
  double good_s_{};         ///< Last time with a good command, or of entry.
  double weight_N_{};
  double hover_thrust_N_{};
};

}  // namespace rosflight::autonomy
