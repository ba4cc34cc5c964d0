// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/flight_events.hpp"
#include "autonomy/fixedwing/flight_config.hpp"

namespace rosflight::autonomy::fixedwing {

/// Detects what ends a normal flight: loss of the state, of the position, of the motor.
///
/// Each function is called once a step, at time t_s [s] that grows, and adds an event when its
/// fault begins (or, for the state, ends). A lost motor stays lost; the other two recover.
class FaultMonitor {
 public:
  static constexpr double kStateGrace_s = 0.1;

  /// Starts the timeouts. Called in the first step.
  void start(double t_s) { state_good_s_ = position_good_s_ = t_s; }

  /// Whether the state has an attitude and is finite, and the link brings and takes what it should.
  bool state_good(const StateEstimate& state, double t_s, FlightEvents& events, bool linked = true);
  bool state_lost() const { return state_lost_; }  ///< Not good for more than kStateGrace_s.

  /// Whether a path can be followed: position and heading exist, and the last aided position is no
  /// older than SafetyConfig::dead_reckoning_s.
  bool position_known(const StateEstimate& state, double t_s, const SafetyConfig& config,
                      FlightEvents& events);
  bool position_lost() const { return position_lost_; }
  /// Time since the last aided position [s].
  double unaided_s(double t_s) const { return t_s - position_good_s_; }

  /// Whether the motor has failed: at full throttle the specific energy falls,
  ///
  ///     h_dot + V (a_x - g sin(theta))/g < -motor_out_m_s                                   (1)
  ///
  /// for more than motor_out_s; a_x is the specific force along the nose, so a_x - g sin(theta) is
  /// the acceleration V_dot.
  /// @param full_throttle  commanded by us, in a phase that flies with the motor.
  bool motor_out(const StateEstimate& state, bool full_throttle, double dt_s,
                 const FlightConfig& config, FlightEvents& events);
  bool motor_lost() const { return motor_lost_; }

 private:
  double state_good_s_{};
  double position_good_s_{};
  double motor_bad_s_{};
  bool state_lost_{false};
  bool position_lost_{false};
  bool motor_lost_{false};
};

}  // namespace rosflight::autonomy::fixedwing
