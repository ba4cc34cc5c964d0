// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/commanded_flight.hpp"

#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

/// Altitude and vertical speed must mean something, or nothing can be flown on them.
bool flyable(const State& s) {
  return s.vertical &&
         std::isfinite(s.p_W.sum() + s.v_W.sum() + s.q_WB.coeffs().sum() + s.w_B.sum());
}

}  // namespace

bool CommandedFlight::on_ground() const {
  return machine_.phase() == Phase::kDisarmed || machine_.phase() == Phase::kLanded;
}

void CommandedFlight::renew(const StateMachineConfig& states) {
  if (!started_ || on_ground()) {
    machine_ = StateMachine(states, config_.mass_kg * config_.gravity_m_s2);
    thrust_watch_.reset();
    apply_config();
  }
  land_ = false;
  out_.landed = false;
}

/// The limits that a settled vehicle needs keep one with a wrong motor model from coming down.
void CommandedFlight::apply_config() {
  ControllerConfig config = config_;
  if (thrust_watch_.found()) {
    config.min_thrust_N = 0.0;
    config.max_descend_acceleration_m_s2 = config.gravity_m_s2;
  }
  controller_.configure(config, controller_.thrust_model());
}

void CommandedFlight::lose_state() {
  if (!state_lost_) out_.events.add(FlightEventType::kStateLost);
  state_lost_ = true;
  out_.command.ignore = kIgnoreAll;
  out_.tracking = false;
}

bool CommandedFlight::check_state(const Input& in) {
  if (flyable(in.state) && GapWatch::linked(in.status.silent_s)) {
    last_good_s_ = in.t_s;
    return true;
  }
  if (in.t_s - last_good_s_ >= kStateGrace_s) lose_state();
  return false;
}

void CommandedFlight::note(bool changed) {
  if (changed) {
    out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(step_.phase));
    if (step_.takeoff_late) out_.events.add(FlightEventType::kTakeoffFailed);
  }
  const bool flying = !step_.idle;
  const bool others = pilot_.any() || failsafe_;
  if (flying && others != pilot_had_it_) {
    if (others) by_failsafe_ = failsafe_;
    using Type = FlightEventType;
    out_.events.add(others ? (by_failsafe_ ? Type::kFailsafeFlies : Type::kPilotTookOver)
                           : (by_failsafe_ ? Type::kFailsafeOver : Type::kPilotGaveBack));
  }
  pilot_had_it_ = flying && others;
  out_.before = out_.phase;
  out_.phase = step_.phase;
  out_.tracking = step_.follow && !others;
  out_.request_disarm = step_.request_disarm;
  out_.landed = out_.landed || step_.phase == Phase::kLanded;
}

CommandedFlight::Turn CommandedFlight::begin(const Input& in) {
  out_.events.count = 0;
  if (!started_) {
    started_ = true;
    last_t_s_ = last_good_s_ = in.t_s;
    return Turn::kNone;
  }
  dt_s_ = in.t_s - last_t_s_;
  if (!(dt_s_ > 0.0)) return Turn::kNone;
  last_t_s_ = in.t_s;
  if (!check_state(in)) return Turn::kNone;
  const bool regained = state_lost_;
  if (regained) out_.events.add(FlightEventType::kStateRegained);
  state_lost_ = false;

  attitude_ = AttitudeView(in.state.q_WB);
  pilot_ = override_.step(in.status.rc_override, dt_s_);
  voltage_V_ = in.status.battery_voltage_V;
  failsafe_ = in.status.failsafe;
  step_ = machine_.step({.t_s = in.t_s,
                         .dt_s = dt_s_,
                         .state = in.state,
                         .psi_rad = attitude_.psi_rad,
                         .armed = in.status.armed,
                         .pilot = pilot_.any() || failsafe_ || regained,
                         .ready = in.ready,
                         .command_good = in.command_good,
                         .land = land_,
                         .thrust_N = out_.thrust_N,
                         .planned = in.planned,
                         .failsafe = failsafe_,
                         .regained = regained,
                         .range_m = in.range_m});
  note(step_.changed);
  if (step_.changed && step_.phase == Phase::kTakeoff) controller_.clear_integrators();
  out_.setpoint = step_.setpoint;
  if (!step_.idle) return step_.follow ? Turn::kFollow : Turn::kOwn;
  out_.command = FirmwareCommand{};
  out_.thrust_N = out_.roll_rad = out_.pitch_rad = out_.yaw_rate_rad_s = 0.0;
  controller_.clear_integrators();
  return Turn::kIdle;
}

void CommandedFlight::finish(const State& state, const ControllerCommand& command) {
  const Controller::Output control =
      controller_.step({state, attitude_, step_.follow ? command : step_.command, dt_s_, pilot_,
                        step_.level || !state.horizontal, voltage_V_});
  out_.command = control.command;
  out_.roll_rad = control.roll_rad;
  out_.pitch_rad = control.pitch_rad;
  out_.yaw_rate_rad_s = control.yaw_rate_rad_s;
  out_.thrust_N = control.thrust_N;
  const double down_m_s = state.v_W.z();
  if (pilot_.throttle || failsafe_) return thrust_watch_.interrupt();
  if (!thrust_watch_.step(control.thrust_N, down_m_s, dt_s_, config_)) return;
  out_.events.add(FlightEventType::kThrustFault, 0, -down_m_s);
  land_ = true;
  apply_config();
}

}  // namespace rosflight::autonomy::multirotor
