// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>

#include "autonomy/common/pid.hpp"
#include "autonomy/fixedwing/types.hpp"
#include "base/constants.hpp"

namespace rosflight::autonomy::fixedwing {

/// Height and airspeed to climb angle and throttle: the part of the controller that is exchanged.
/// Write your own by deriving from it (docs/autonomy/fixedwing-control.md shows how).
class LongitudinalLaw {
 public:
  struct Input {
    double dt_s{};  ///< > 0
    double height_m{};
    double climb_m_s{};
    double airspeed_m_s{};
    double airspeed_rate_m_s2{};
    double height_c_m{};
    double airspeed_c_m_s{};
    double climb_ff_m_s{};   ///< Climb rate of the reference.
    double throttle_ff{};    ///< What the vehicle needs for airspeed_c, climb_ff and bank.
    double min_climb_rad{};  ///< Limits of the answer,
    double max_climb_rad{};  ///< the speed guard's included.
    double min_throttle{};
    double max_throttle{1.0};
    double speed_share{1.0};    ///< Weight of the airspeed in the climb angle; 0: throttle alone.
    bool airspeed_known{true};  ///< If not: throttle_ff is flown, and height by climb angle alone.
  };
  struct Output {
    double climb_angle_rad{};
    double throttle{};
  };

  LongitudinalLaw() = default;
  LongitudinalLaw(const LongitudinalLaw&) = delete;
  LongitudinalLaw& operator=(const LongitudinalLaw&) = delete;
  virtual ~LongitudinalLaw() = default;

  /// Climb angle and throttle within the limits of the input. Called once a period.
  virtual Output step(const Input& in) = 0;
  /// Clears integrals, for a new flight.
  virtual void reset() = 0;
};

struct SuccessiveLoopConfig {
  PidGains height{0.018, 0.0015, 0.012};  ///< m -> rad; kd acts on the climb rate.
  PidGains airspeed{0.12, 0.03, 0.05};    ///< m/s -> throttle; kd acts on its rate.
  double max_height_error_m{12.0};        ///< Farther away the error counts as this much.

  bool operator==(const SuccessiveLoopConfig&) const = default;
};

/// Altitude to climb angle and airspeed to throttle, one loop each.
///
///     gamma_c = asin(h_dot_ff/V) + kp e + I + kd (h_dot_ff - h_dot),  e = clip(h_c - h)     (1)
///     throttle = throttle_ff + kp (V_c - V) + I - kd V_dot                                  (2)
///
/// Beard & McLain, Small Unmanned Aircraft, 2012, sec. 6.4 (altitude by pitch, airspeed by
/// throttle), with the ramp of the reference fed forward. Integrals stop at the limits (Pid).
class SuccessiveLoops final : public LongitudinalLaw {
 public:
  /// Height error -> climb angle [rad], airspeed error -> throttle [0..1].
  explicit SuccessiveLoops(const SuccessiveLoopConfig& config);
  Output step(const Input& in) override;
  void reset() override;

 private:
  SuccessiveLoopConfig config_;
  Pid height_;
  Pid airspeed_;
};

struct TotalEnergyConfig {
  PidGains energy{2.5, 0.7, 1.0};    ///< Relative energy error -> throttle.
  PidGains balance{0.9, 0.07, 0.5};  ///< Relative energy difference -> rad.
  double max_height_error_m{12.0};
  double gravity_m_s2{base::kStandardGravity_m_s2};

  bool operator==(const TotalEnergyConfig&) const = default;
};

/// Total energy control: throttle makes energy, pitch shares it between height and speed.
///
///     K_ref = V_c^2/2,  K = (V_c^2 - V^2)/2,  U = g clip(h_c - h)        per mass           (1)
///     E = (U + K)/K_ref,  L = (U - K)/K_ref                                                 (2)
///     throttle = throttle_ff + kp E + I_E + kd E_dot                                        (3)
///     gamma_c = asin(h_dot_ff/V) + kp L + I_L + kd L_dot                                    (4)
///
/// with E_dot, L_dot = (g (h_dot_ff - h_dot) -+ V V_dot)/K_ref. (1), (2) as ROSflight's rosplane;
/// Lambregts, Integrated system for vertical flight path and airspeed control, AIAA 83-3561; Beard
/// & McLain, Small Unmanned Aircraft, 2nd draft, sec. 6.6. Reference airspeed below 1 m/s counts as
/// 1 m/s.
class TotalEnergy final : public LongitudinalLaw {
 public:
  /// gravity_m_s2 > 0.
  explicit TotalEnergy(const TotalEnergyConfig& config);
  Output step(const Input& in) override;
  void reset() override;

 private:
  TotalEnergyConfig config_;
  Pid energy_;
  Pid balance_;
};

}  // namespace rosflight::autonomy::fixedwing
