// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/fault_monitor.hpp"

#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {

bool FaultMonitor::state_good(const StateEstimate& s, double t_s, FlightEvents& events,
                              bool linked) {
  const bool good = linked && s.attitude != Quality::kNone &&
                    std::isfinite(s.p_W.sum() + s.v_W.sum() + s.q_WB.coeffs().sum() + s.w_B.sum() +
                                  s.a_B.sum() + s.airspeed_m_s + s.course_rad);
  if (good) {
    if (state_lost_) events.add(FlightEventType::kStateRegained);
    state_lost_ = false;
    state_good_s_ = t_s;
    return true;
  }
  if (t_s - state_good_s_ <= kStateGrace_s) return false;
  if (!state_lost_) events.add(FlightEventType::kStateLost);
  state_lost_ = true;
  return false;
}

bool FaultMonitor::position_known(const StateEstimate& s, double t_s, const SafetyConfig& config,
                                  FlightEvents& events) {
  if (s.horizontal == Quality::kGood && s.heading != Quality::kNone) position_good_s_ = t_s;
  const bool known = s.horizontal != Quality::kNone && s.heading != Quality::kNone &&
                     t_s - position_good_s_ <= config.dead_reckoning_s;
  if (!known && !position_lost_) events.add(FlightEventType::kPositionLost);
  position_lost_ = !known;
  return known;
}

bool FaultMonitor::motor_out(const StateEstimate& s, bool full_throttle, double dt_s,
                             const FlightConfig& config, FlightEvents& events) {
  const double gravity_m_s2 = config.controller.airframe.gravity_m_s2;
  const double along_nose = s.a_B.x() - gravity_m_s2 * std::sin(RollPitch::of(s.q_WB).pitch_rad);
  const double energy_m_s = -s.v_W.z() + s.airspeed_m_s * along_nose / gravity_m_s2;
  const bool bad = full_throttle && energy_m_s < -config.safety.motor_out_m_s;
  motor_bad_s_ = bad ? motor_bad_s_ + dt_s : 0.0;
  if (motor_bad_s_ > config.safety.motor_out_s && !motor_lost_) {
    motor_lost_ = true;
    events.add(FlightEventType::kMotorOut);
  }
  return motor_lost_;
}

}  // namespace rosflight::autonomy::fixedwing
