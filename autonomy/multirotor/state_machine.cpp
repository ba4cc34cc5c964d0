// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/state_machine.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kHoverAverage_s = 2.0;
constexpr double kMinClimb_m_s = 0.3;

}  // namespace

StateMachine::StateMachine(const StateMachineConfig& config, double weight_N)
    : config_(config), landing_(config.landing), weight_N_(weight_N), hover_thrust_N_(weight_N) {}

void StateMachine::configure(const StateMachineConfig& config) {
  config_ = config;
  if (phase_ != Phase::kLanding) landing_ = Landing(config.landing);
}

bool StateMachine::command_good(const ControllerCommand& command, double age_s) const {
  const auto& c = command.cmd;
  return command.valid && age_s >= 0.0 && age_s <= config_.command_timeout_s &&
         static_cast<std::size_t>(command.mode) < kControlModes &&
         std::isfinite(c[0] + c[1] + c[2] + c[3]);
}

void StateMachine::hold_here(const Input& in) {
  hold_W_ = in.state.p_W;
  hold_psi_rad_ = in.psi_rad;
}

bool StateMachine::settled(const Input& in) const {
  return (in.state.p_W - hold_W_).norm() <= config_.settle_distance_m &&
         in.state.v_W.norm() <= config_.settle_speed_m_s;
}

/// The range sensor reads what it did before the take-off.
bool StateMachine::at_ground(const Input& in) const {
  constexpr double kSlack_m = 0.1;
  return in.range_m && standing_range_m_ && *in.range_m < *standing_range_m_ + kSlack_m;
}

bool StateMachine::low(const Input& in) const {
  constexpr double kLow_m = 0.6;
  const bool flying = phase_ != Phase::kDisarmed && phase_ != Phase::kTakeoff;
  return flying && (ground_down_m_ - in.state.p_W.z() < kLow_m || at_ground(in));
}

/// The range sensor's first reading may come a little later than the first state.
void StateMachine::watch_gap(const Input& in) {
  constexpr double kFirstReadings_s = 0.5;
  if (phase_ == Phase::kDisarmed || phase_ == Phase::kTakeoff) brought_down_ = false;
  if (in.regained) gap_judged_until_s_ = in.t_s + kFirstReadings_s;
  if (in.t_s <= gap_judged_until_s_ && low(in)) brought_down_ = true;
}

void StateMachine::watch_failsafe(const Input& in) {
  constexpr double kRests_m_s = 0.3;
  const bool rests = low(in) && std::abs(in.state.v_W.z()) < kRests_m_s;
  grounded_s_ = rests && in.failsafe ? grounded_s_ + in.dt_s : 0.0;
  if (rests && failsafe_before_ && !in.failsafe) grounded_s_ = 2.0 * kGrounded_s;
  failsafe_before_ = in.failsafe;
}

PhaseConditions StateMachine::conditions(const Input& in) const {
  const double height_m = ground_down_m_ - in.state.p_W.z();
  const double phase_s = in.t_s - since_s_;
  PhaseConditions out;
  out.set(Conditions::kArmed, in.armed);
  out.set(Conditions::kReady, in.ready);
  out.set(Conditions::kCommandGood, in.command_good);
  out.set(Conditions::kPilot, in.pilot);
  out.set(Conditions::kLandAsked, in.land || brought_down_);
  out.set(Conditions::kLiftedOff, height_m > config_.lift_off_height_m);
  out.set(Conditions::kHeightReached,
          height_m >= config_.takeoff_height_m - config_.takeoff_tolerance_m);
  out.set(Conditions::kTakeoffLate, phase_s > config_.takeoff_timeout_s);
  const bool settle_timeout = !(phase_s < config_.hold_s + config_.settle_timeout_s);
  out.set(Conditions::kHoldOver, phase_s >= config_.hold_s && (settled(in) || settle_timeout));
  out.set(Conditions::kCommandLost, in.t_s - good_s_ > config_.lost_command_land_s);
  out.set(Conditions::kTouched, landing_step_.touched || grounded_s_ > kGrounded_s);
  return out;
}

void StateMachine::enter(Phase to, const Input& in) {
  const Phase from = phase_;
  phase_ = to;
  since_s_ = good_s_ = in.t_s;
  switch (to) {
    case Phase::kTakeoff:
      hold_here(in);
      ground_down_m_ = in.state.p_W.z();
      standing_range_m_ = in.range_m;
      hover_thrust_N_ = weight_N_;
      break;
    case Phase::kPositionHold:
      if (from == Phase::kTakeoff && !in.pilot) {
        hold_W_.z() = ground_down_m_ - config_.takeoff_height_m;
      } else {
        hold_here(in);
      }
      break;
    case Phase::kLanding:
      if (from == Phase::kOffboard) {
        hold_here(in);
        if (in.planned != nullptr) {
          hold_W_ = in.planned->p_W;
          hold_psi_rad_ = in.planned->psi_rad;
        }
      }
      landing_.start();
      landing_step_ = {};
      break;
    case Phase::kDisarmed:
    case Phase::kOffboard:
    case Phase::kLanded:
      break;
  }
}

void StateMachine::learn_hover_thrust(const Input& in, bool descending_freely) {
  const bool flying =
      phase_ == Phase::kPositionHold || phase_ == Phase::kOffboard || descending_freely;
  if (!flying || in.pilot || !(in.thrust_N > 0.0)) return;
  hover_thrust_N_ += (in.thrust_N - hover_thrust_N_) * std::min(in.dt_s / kHoverAverage_s, 1.0);
}

void StateMachine::fly(const Input& in, Output& out) {
  out.setpoint.p_W = hold_W_;
  out.setpoint.psi_rad = hold_psi_rad_;
  out.command.valid = true;
  out.command.mode = ControlMode::kNposEposDvelYaw;
  const double height_m = ground_down_m_ - in.state.p_W.z();
  double down_speed_m_s = 0.0;
  if (phase_ == Phase::kPositionHold) {
    out.command.mode = ControlMode::kNposEposDposYaw;
    out.command.cmd = {hold_W_.x(), hold_W_.y(), hold_W_.z(), hold_psi_rad_};
    return;
  }
  if (phase_ == Phase::kTakeoff) {
    const double left_m = config_.takeoff_height_m - height_m;
    down_speed_m_s = -std::clamp(left_m, std::min(kMinClimb_m_s, config_.takeoff_speed_m_s),
                                 config_.takeoff_speed_m_s);
    out.level = height_m < config_.lift_off_height_m;
  } else {
    landing_step_ = landing_.step(
        {in.dt_s, in.state.v_W.z(), height_m, in.thrust_N, hover_thrust_N_, at_ground(in)});
    down_speed_m_s = landing_step_.down_speed_m_s;
    out.level = landing_step_.unloading;
    const bool free = !landing_step_.unloading && in.state.v_W.z() > 0.6 * down_speed_m_s;
    learn_hover_thrust(in, free);
    if (landing_step_.unloading) {
      out.command.mode = ControlMode::kRollPitchYawrateThrust;
      out.command.cmd = {0.0, 0.0, 0.0, landing_step_.thrust_N};
      out.setpoint.p_W.z() = in.state.p_W.z();
      return;
    }
  }
  out.setpoint.p_W.z() = in.state.p_W.z();
  out.setpoint.v_W.z() = down_speed_m_s;
  out.command.cmd = {hold_W_.x(), hold_W_.y(), down_speed_m_s, hold_psi_rad_};
}

StateMachine::Output StateMachine::step(const Input& in) {
  Output out;
  if (in.command_good) good_s_ = in.t_s;
  learn_hover_thrust(in, false);
  watch_failsafe(in);
  watch_gap(in);
  const PhaseConditions now = conditions(in);
  const Phase to = kPhaseTable.next(phase_, now.bits());
  const bool gives_up = to == Phase::kLanding || to == Phase::kLanded;
  out.takeoff_late = phase_ == Phase::kTakeoff && gives_up && now.has(Conditions::kTakeoffLate);
  out.changed = to != phase_;
  const bool waits = in.pilot && (to == Phase::kPositionHold || to == Phase::kTakeoff);
  if (out.changed) {
    enter(to, in);
  } else if (waits) {
    hold_here(in);
    since_s_ = good_s_ = in.t_s;
    if (to == Phase::kTakeoff) {
      ground_down_m_ = in.state.p_W.z();
      standing_range_m_ = in.range_m;
    }
  }
  out.phase = phase_;
  out.idle = phase_ == Phase::kDisarmed || phase_ == Phase::kLanded;
  out.follow = phase_ == Phase::kOffboard;
  out.request_disarm = phase_ == Phase::kLanded;
  if (out.idle) {
    out.setpoint.p_W = in.state.p_W;
    out.setpoint.psi_rad = in.psi_rad;
  } else if (!out.follow) {
    fly(in, out);
  }
  return out;
}

}  // namespace rosflight::autonomy::multirotor
