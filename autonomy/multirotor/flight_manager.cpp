// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/flight_manager.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace rosflight::autonomy {
namespace {

constexpr double kNearPlan_m = 1.0;  // closer than this the plan goes on from its own setpoint
constexpr double kNearPlan_m_s = 0.5;

bool finite(const State& s) {
  return std::isfinite(s.p_N.sum() + s.v_N.sum() + s.q_NB.coeffs().sum() + s.w_B.sum());
}

StateMachineConfig with_height(StateMachineConfig config, const Mission& mission) {
  if (mission.takeoff_height_m) config.takeoff_height_m = *mission.takeoff_height_m;
  return config;
}

PathConfig with_cycle(PathConfig config, const Mission& mission) {
  config.cycle = mission.at_end == AtEnd::kCycle;
  return config;
}

}  // namespace

FlightManager::FlightManager(const FlightConfig& config, const Mission& mission,
                             std::unique_ptr<TrajectoryLaw> law)
    : config_(config),
      follower_(law ? std::move(law) : std::make_unique<TrajectoryFollower>(config.follower)),
      controller_(config.controller, config.thrust) {
  const double weight_N = config.controller.mass_kg * config.controller.gravity_m_s2;
  if (config.thrust.max_thrust_N() < 1.1 * weight_N) {
    throw std::invalid_argument("the vehicle weighs " + std::to_string(weight_N) +
                                " N and full throttle gives " +
                                std::to_string(config.thrust.max_thrust_N()) + " N: it cannot fly");
  }
  set_mission(mission);
}

void FlightManager::set_mission(const Mission& mission) {
  if (mission.waypoints.empty()) throw std::invalid_argument("the mission has no waypoint");
  const double weight_N = config_.controller.mass_kg * config_.controller.gravity_m_s2;
  const bool on_ground = machine_.phase() == Phase::kDisarmed || machine_.phase() == Phase::kLanded;
  if (!started_ || on_ground) {
    path_ = PathManager(with_cycle(config_.path, mission));
    machine_ = StateMachine(with_height(config_.states, mission), weight_N);
  } else {
    path_.set_cycle(mission.at_end == AtEnd::kCycle);
  }
  path_.set_waypoints(mission.waypoints);
  at_end_ = mission.at_end;
  land_ = flown_ = false;
  command_good_ = true;
  out_.mission_done = out_.landed = false;
}

void FlightManager::event(FlightEventType type, std::size_t index, double value) {
  if (out_.event_count < FlightOutput::kMaxEvents)
    out_.events[out_.event_count++] = {type, index, value};
}

bool FlightManager::check_state(double t_s, const State& state) {
  if (finite(state)) {
    last_good_s_ = t_s;
    return true;
  }
  if (t_s - last_good_s_ >= kStateGrace_s) {
    if (!state_lost_) event(FlightEventType::kStateLost);
    state_lost_ = true;
    out_.command.ignore = kIgnoreAll;
    out_.tracking = false;
  }
  return false;
}

bool FlightManager::near_plan(const State& state) const {
  return (out_.setpoint.p_N - state.p_N).squaredNorm() < kNearPlan_m * kNearPlan_m &&
         (out_.setpoint.v_N - state.v_N).squaredNorm() < kNearPlan_m_s * kNearPlan_m_s;
}

void FlightManager::start_path(double t_s, const State& state, const AttitudeView& attitude) {
  Trajectory from;
  if (near_plan(state)) {
    from.p_N = out_.setpoint.p_N;
    from.psi_rad = wrap_angle(out_.setpoint.psi_rad);
  } else {
    from.p_N = state.p_N;
    from.v_N = state.v_N;
    from.psi_rad = attitude.psi_rad;
  }
  path_.start(t_s, from);
}

void FlightManager::hand_over(const StateMachine::Output& machine, double t_s, const State& state,
                              const AttitudeView& attitude) {
  event(FlightEventType::kPhase, static_cast<std::size_t>(machine.phase));
  if (machine.takeoff_late) event(FlightEventType::kTakeoffFailed);
  if (machine.follow) {
    start_path(t_s, state, attitude);
    follower_->restart(controller_.trim_N());
    return;
  }
  if (out_.phase == Phase::kOffboard) {
    path_.stop();
    controller_.enter(machine.command.mode, follower_->trim_N());
  }
  if (machine.phase == Phase::kTakeoff) controller_.clear_integrators();
  if (machine.phase == Phase::kLanded) flown_ = true;
}

ControllerCommand FlightManager::follow(double t_s, double dt_s, const State& state,
                                        const AttitudeView& attitude, const PilotOverride& pilot) {
  const PathManager::Output path = path_.step(t_s, state.p_N, attitude.psi_rad);
  if (path.event != PathManager::Event::kNone) {
    const bool reached = path.event == PathManager::Event::kReached;
    event(reached ? FlightEventType::kWaypointReached : FlightEventType::kWaypointMissed,
          path.event_waypoint, path.event_distance_m);
  }
  if (path.done && !out_.mission_done) {
    out_.mission_done = true;
    event(FlightEventType::kMissionDone);
    if (at_end_ == AtEnd::kLand) land_ = true;
  }
  out_.setpoint = path.setpoint;
  out_.waypoint = path.waypoint;
  out_.distance_m = path.distance_m;
  return follower_->step({state, attitude, out_.setpoint, 0.0, dt_s, pilot});
}

void FlightManager::note(const StateMachine::Output& machine, const PilotOverride& pilot) {
  const bool flying = !machine.idle;
  if (flying && pilot.any() != pilot_) {
    event(pilot.any() ? FlightEventType::kPilotTookOver : FlightEventType::kPilotGaveBack);
  }
  pilot_ = flying && pilot.any();
  out_.phase = machine.phase;
  out_.tracking = machine.follow && !pilot.any();
  out_.request_disarm = machine.request_disarm;
  out_.landed = out_.landed || machine.phase == Phase::kLanded;
}

const FlightOutput& FlightManager::step(double t_s, const State& state, const Status& status) {
  out_.event_count = 0;
  if (!started_) {
    started_ = true;
    last_t_s_ = last_good_s_ = t_s;
    return out_;
  }
  const double dt_s = t_s - last_t_s_;
  if (!(dt_s > 0.0)) return out_;
  last_t_s_ = t_s;
  if (!check_state(t_s, state)) return out_;
  const bool regained = state_lost_;
  if (regained) event(FlightEventType::kStateRegained);
  state_lost_ = false;

  const AttitudeView attitude(state.q_NB);
  const PilotOverride pilot = PilotOverride::from_word(status.rc_override);
  const StateMachine::Output machine =
      machine_.step({.t_s = t_s,
                     .dt_s = dt_s,
                     .state = state,
                     .psi_rad = attitude.psi_rad,
                     .armed = status.armed,
                     .pilot = pilot.any() || regained,
                     .ready = !flown_,
                     .command_good = command_good_,
                     .land = land_,
                     .thrust_N = out_.thrust_N,
                     .planned = near_plan(state) ? &out_.setpoint : nullptr});
  if (machine.changed) hand_over(machine, t_s, state, attitude);
  note(machine, pilot);
  command_good_ = true;
  if (machine.idle) {
    out_.command = FirmwareCommand{};
    out_.thrust_N = out_.roll_rad = out_.pitch_rad = out_.yaw_rate_rad_s = 0.0;
    out_.setpoint = machine.setpoint;
    controller_.clear_integrators();
    return out_;
  }
  ControllerCommand command = machine.command;
  if (machine.follow) {
    command = follow(t_s, dt_s, state, attitude, pilot);
    command_good_ = machine_.command_good(command, 0.0);
    if (!command_good_) return out_;  // the machine holds the position from the next step on
  } else {
    out_.setpoint = machine.setpoint;
  }
  const Controller::Output control = controller_.step(
      {state, attitude, command, dt_s, pilot, machine.level, status.battery_voltage_V});
  out_.command = control.command;
  out_.roll_rad = control.roll_rad;
  out_.pitch_rad = control.pitch_rad;
  out_.yaw_rate_rad_s = control.yaw_rate_rad_s;
  out_.thrust_N = control.thrust_N;
  return out_;
}

}  // namespace rosflight::autonomy
