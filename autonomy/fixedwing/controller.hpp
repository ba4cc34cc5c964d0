// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>

#include "autonomy/common/pid.hpp"
#include "autonomy/fixedwing/aileron_watch.hpp"
#include "autonomy/fixedwing/longitudinal.hpp"
#include "autonomy/fixedwing/types.hpp"
#include "base/constants.hpp"

namespace rosflight::autonomy::fixedwing {

/// Airframe data of the controller. A zero lift_slope means unknown: pitch_trim_rad is used.
struct Airframe {
  double mass_kg{4.5};
  double gravity_m_s2{base::kStandardGravity_m_s2};
  double wing_area_m2{0.52};
  double density_kg_m3{1.07};
  double lift_zero{0.506};        ///< C_L at no angle of attack.
  double lift_slope_1_rad{5.61};  ///< C_L per angle of attack.
  double pitch_trim_rad{0.02};    ///< Pitch of level flight where the two above are unknown.
  double elevator_trim{0.0};      ///< Elevator at no angle of attack,
  double elevator_1_rad{0.0};     ///< and its change per angle of attack, both by effect.
};

enum class LongitudinalKind : std::uint8_t { kSuccessiveLoops, kTotalEnergy };

struct ControllerConfig {
  Airframe airframe{};
  LongitudinalKind longitudinal{LongitudinalKind::kTotalEnergy};
  SuccessiveLoopConfig successive_loops{};
  TotalEnergyConfig total_energy{};

  PidGains course{2.2, 0.01, 0.0};        ///< rad -> rad of bank.
  PidGains roll{1.1, 0.3, 0.06};          ///< rad -> aileron at cruise; kd acts on the roll rate.
  PidGains pitch{1.8, 1.5, 0.15};         ///< rad -> elevator at cruise; kd acts on the pitch rate.
  double full_aileron_rad_s{3.6};         ///< Roll rate of an aileron of 1 at cruise; 0: unknown.
  double yaw_damper_s{0.25};              ///< rad/s -> rudder at cruise.
  double yaw_washout_rad_s{0.6};          ///< Corner below which a yaw rate is a turn, not a swing.
  PidGains ground_course{1.2, 0.0, 0.4};  ///< rad -> rudder while rolling on wheels.
  PidGains roll_by_rudder{0.8, 0.25,
                          0.4};          ///< rad -> rudder at cruise, once the ailerons are lost.
  PidGains climb_rate{0.05, 0.04, 0.0};  ///< m/s -> rad, of the flare.
  PidGains glide{0.04, 0.01, 0.0};       ///< m/s -> rad, airspeed by pitch.
  double glide_rad{-6.0 * kRadPerDeg};   ///< Angle it starts from.

  double cruise_m_s{15.0};
  double min_airspeed_m_s{11.5};    ///< Speed guard: nothing may pitch up below it.
  double speed_guard_rad_s_m{0.1};  ///< Climb angle given up per speed missing.
  double max_roll_rad{45.0 * kRadPerDeg};
  double max_roll_rate_rad_s{90.0 * kRadPerDeg};  ///< Max rate of the commanded bank.
  double max_pitch_rad{25.0 * kRadPerDeg};
  double min_pitch_rad{-20.0 * kRadPerDeg};
  double max_alpha_rad{10.0 * kRadPerDeg};  ///< Stall guard; the wing stalls at 11.6 deg.
  double max_climb_rad{15.0 * kRadPerDeg};
  double max_descent_rad{12.0 * kRadPerDeg};
  double throttle_cruise{0.5};
  double throttle_per_climb{1.5};       ///< Throttle per climb angle,
  double throttle_per_speed_s_m{0.03};  ///< per airspeed above cruise,
  double throttle_per_load{0.1};        ///< and per load factor above one.
  double min_throttle{0.0};
  double max_throttle{1.0};
  double command_timeout_s{1.0};
  double lost_roll_rad{20.0 * kRadPerDeg};
};

/// Course, height and airspeed to surfaces and throttle.
///
///     phi_c = phi_ff + kp wrap(chi_c - chi) + I,  rate limited                              (1)
///     aileron  = (V0/V)^2 [kp (phi_c - phi) + I - kd p]                                     (2)
///     theta_c  = gamma_c + alpha(V, phi),  alpha = (m g/(q S cos phi) - C_L0)/C_La          (3)
///     elevator = trim + c alpha + (V0/V)^2 [kp (theta_c - theta) + I - kd (q - q_turn)],
///                q_turn = g/V tan phi sin phi                                               (4)
///     rudder   = -(V0/V)^2 k s/(s + w) r                                                    (5)
///
/// gamma_c and throttle come from the LongitudinalLaw. Beard & McLain, Small Unmanned Aircraft,
/// 2012, ch. 6: successive loop closure; (5) its washout, in Tustin's form. The square of V0/V
/// keeps the loop gains, as surfaces work with dynamic pressure; it stays within 0.4 to 2.5.
///
/// Speed guard: gamma_c <= k (V - V_min), so a vehicle that gets slow - motor off, climb too steep -
/// gives height for speed. Without a known airspeed V is cruise and the throttle is fed forward.
///
/// Stall guard: theta_c <= asin(h_dot/V) + alpha_max cos(phi). A wing that a gust has stalled
/// sinks, and a law that holds its height would keep the nose up and the wing stalled, however
/// fast.
///
/// Ailerons lost (AileronWatch): the rudder rolls by way of sideslip and dihedral,
///
///     rudder = (V0/V)^2 [kp (phi_c - phi) + I - kd p - k s/(s + w) r]                       (6)
///
/// with a share of the bank that (1) asks for and no more than 15 deg, as this takes seconds, less
/// the bank that balances the force of the sideslip, atan(a_y/g).
///
/// Stops: without a valid command younger than command_timeout_s it circles: bank lost_roll_rad,
/// height of the last good command (its own if there was none), cruise; Output::lost is set. A
/// state that is not finite: the last output is repeated. Axes the pilot holds lose their
/// integrals.
class Controller {
 public:
  /// Parts of the command that are given directly.
  struct Direct {
    std::optional<double> roll_rad;
    std::optional<double> pitch_rad;
    std::optional<double> climb_m_s;  ///< Climb rate instead of height: the flare.
    std::optional<double> throttle;
    std::optional<double> ground_course_rad;      ///< Rolling: rudder steers, wings level.
    std::optional<double> airspeed_by_pitch_m_s;  ///< Climb angle for this airspeed: the glide.
    double speed_share{1.0};     ///< Weight of the airspeed in the climb angle (LongitudinalLaw).
    double min_pitch_rad{-kPi};  ///< Closer limits of theta_c and phi_c.
    double max_pitch_rad{kPi};
    double max_roll_rad{kPi};
    double max_throttle{1.0};
  };
  struct Input {
    const StateEstimate& state;
    const ControllerCommand& command;
    double command_age_s{};
    double dt_s{};  ///< <= 0: the last output is repeated.
    PilotOverride pilot{};
    Direct direct{};
  };
  struct Output {
    Surfaces surfaces{};
    double roll_c_rad{};
    double pitch_c_rad{};
    double climb_angle_c_rad{};
    double height_c_m{};
    double airspeed_c_m_s{};
    bool lost{};         ///< No command: circling.
    bool speed_guard{};  ///< Active.
    bool throttle_full{};
    bool aileron_lost{};  ///< The rudder rolls.
  };

  Controller() : Controller(ControllerConfig{}) {}
  /// With the longitudinal law that the configuration names.
  explicit Controller(const ControllerConfig& config);
  /// Controller with another longitudinal law.
  Controller(const ControllerConfig& config, std::unique_ptr<LongitudinalLaw> law);

  /// Surfaces and throttle for one period dt_s. Cannot fail; see the class for invalid input.
  const Output& step(const Input& in);
  /// Clears integrals, filters and the last output, for a new flight.
  void reset();
  /// Gains change; the longitudinal law is made again, its integrals forgotten, if its own have
  /// changed.
  void configure(const ControllerConfig& config);
  const ControllerConfig& config() const { return config_; }

 private:
  struct Motion;
  double bank(const Input& in, const Motion& m, const ControllerCommand& command, bool lost);
  void longitudinal(const Input& in, const Motion& m, const ControllerCommand& command);
  void surfaces(const Input& in, const Motion& m);
  double angle_of_attack(double airspeed_m_s, double roll_rad) const;

  ControllerConfig config_{};
  std::unique_ptr<LongitudinalLaw> law_;
  Pid course_, roll_, roll_by_rudder_, pitch_, climb_rate_, glide_;
  AileronWatch ailerons_;
  Output out_{};
  double roll_c_rad_{};
  double airspeed_rate_m_s2_{};
  double side_force_m_s2_{};
  double washout_{};
  double yaw_rate_rad_s_{};
  double lost_height_m_{};
  bool had_command_{false};
  bool fresh_{true};
};

}  // namespace rosflight::autonomy::fixedwing
