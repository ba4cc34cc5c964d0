// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/flight_manager.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace rosflight::autonomy::multirotor {
namespace {

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
      control_(config.controller, config.thrust) {
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
  if (!control_.started() || control_.on_ground()) {
    path_ = PathManager(with_cycle(config_.path, mission));
  } else {
    path_.set_cycle(mission.at_end == AtEnd::kCycle);
  }
  control_.renew(with_height(config_.states, mission));
  path_.set_waypoints(mission.waypoints);
  at_end_ = mission.at_end;
  flown_ = false;
  command_good_ = true;
  out_.mission_done = out_.landed = false;
}

void FlightManager::start_path(double t_s, const State& state) {
  path_.start(t_s, path_start(state, control_.attitude().psi_rad, out_.setpoint));
}

void FlightManager::hand_over(double t_s, const State& state) {
  const CommandedFlight::Output& control = control_.output();
  if (control.phase == Phase::kOffboard) {
    start_path(t_s, state);
    follower_->restart(control_.trim_W());
    return;
  }
  if (control.before == Phase::kOffboard) {
    path_.stop();
    control_.take_over(follower_->trim_W());
  }
  if (control.phase == Phase::kLanded) flown_ = true;
}

ControllerCommand FlightManager::follow(double t_s, const State& state) {
  const AttitudeView& attitude = control_.attitude();
  const PathManager::Output path = path_.step(t_s, state.p_W, attitude.psi_rad);
  if (path.event != PathManager::Event::kNone) {
    const bool reached = path.event == PathManager::Event::kReached;
    out_.events.add(reached ? FlightEventType::kWaypointReached : FlightEventType::kWaypointMissed,
                    path.event_waypoint, path.event_distance_m);
  }
  if (path.done && !out_.mission_done) {
    out_.mission_done = true;
    out_.events.add(FlightEventType::kMissionDone);
    if (at_end_ == AtEnd::kLand) control_.request_land();
  }
  out_.setpoint = path.setpoint;
  out_.waypoint = path.waypoint;
  out_.distance_m = path.distance_m;
  return follower_->step({state, attitude, out_.setpoint, 0.0, control_.dt_s(), control_.pilot()});
}

const FlightOutput& FlightManager::step(const Input& in) {
  using Turn = CommandedFlight::Turn;
  const Turn turn =
      control_.begin({.t_s = in.t_s,
                      .state = in.state,
                      .status = in.status,
                      .ready = !flown_,
                      .command_good = command_good_,
                      .planned = near_plan(in.state, out_.setpoint) ? &out_.setpoint : nullptr});
  const CommandedFlight::Output& control = control_.output();
  out_.events = control.events;
  if (turn == Turn::kNone) {
    out_.command = control.command;
    out_.tracking = control.tracking;
    return out_;
  }
  if (control.phase != control.before) hand_over(in.t_s, in.state);
  out_.phase = control.phase;
  out_.tracking = control.tracking;
  out_.request_disarm = control.request_disarm;
  out_.landed = control.landed;
  command_good_ = true;
  if (turn == Turn::kFollow) {
    const ControllerCommand command = follow(in.t_s, in.state);
    command_good_ = control_.command_good(command, 0.0);
    if (!command_good_) return out_;  // the machine holds the position from the next step on
    control_.finish(in.state, command);
  } else {
    out_.setpoint = control.setpoint;
    if (turn == Turn::kOwn) control_.finish(in.state, {});
  }
  out_.command = control.command;
  out_.roll_rad = control.roll_rad;
  out_.pitch_rad = control.pitch_rad;
  out_.yaw_rate_rad_s = control.yaw_rate_rad_s;
  out_.thrust_N = control.thrust_N;
  return out_;
}

}  // namespace rosflight::autonomy::multirotor
