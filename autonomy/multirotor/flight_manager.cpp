// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/flight_manager.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace rosflight::autonomy::multirotor {
namespace {

StateMachineConfig with_height(StateMachineConfig config,
                               const std::optional<double>& takeoff_height_m) {
  if (takeoff_height_m) config.takeoff_height_m = *takeoff_height_m;
  return config;
}

PathConfig with_cycle(PathConfig config, bool cycle) {
  config.cycle = cycle;
  return config;
}

}  // namespace

FlightManager::FlightManager(const FlightConfig& config, const Mission& mission,
                             std::unique_ptr<TrajectoryLaw> law)
    : config_(config),
      follower_(law ? std::move(law) : std::make_unique<TrajectoryFollower>(config.follower)),
      control_(config.controller, config.thrust),
      rotors_(config.rotor_watch) {
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
  const bool cycle = mission.at_end == AtEnd::kCycle;
  if (!control_.started() || control_.on_ground()) {
    path_ = PathManager(with_cycle(config_.path, cycle));
  } else {
    path_.set_cycle(cycle);
  }
  takeoff_height_m_ = mission.takeoff_height_m;
  control_.renew(with_height(config_.states, takeoff_height_m_));
  path_.set_waypoints(mission.waypoints);
  at_end_ = mission.at_end;
  fence_ = mission.fence;
  if (control_.on_ground()) {
    limits_.start(config_.battery, fence_);
  } else {
    limits_.set_fence(fence_);
  }
  return_asked_ = returning_ = gap_returns_ = false;
  unplaced_s_ = hold_until_s_ = 0.0;
  flown_ = false;
  command_good_ = true;
  out_.mission_done = out_.landed = false;
}

void FlightManager::configure(const FlightConfig& config) {
  config_ = config;
  path_.configure(with_cycle(config.path, path_.config().cycle));
  if (auto* follower = dynamic_cast<TrajectoryFollower*>(follower_.get()))
    follower->configure(config.follower);
  control_.configure(controller_config(), with_height(config.states, takeoff_height_m_));
  control_.set_thrust_model(config.thrust);
  limits_.configure(config.battery);
}

void FlightManager::set_altitude_offset(double offset_m) {
  if (control_.output().phase == Phase::kOffboard && !returning_) altitude_offset_m_ = offset_m;
}

void FlightManager::start_path(double t_s, const State& state) {
  path_.start(t_s, path_start(state, control_.attitude().psi_rad, out_.setpoint));
}

void FlightManager::hand_over(double t_s, const State& state) {
  const CommandedFlight::Output& control = control_.output();
  if (control.phase == Phase::kTakeoff) {
    start_W_ = state.p_W;
    hover_thrust_N_ = config_.controller.mass_kg * config_.controller.gravity_m_s2;
  }
  if (control.phase == Phase::kOffboard) {
    start_path(t_s, state);
    follower_->restart(control_.trim_W());
    return;
  }
  if (control.before == Phase::kOffboard) {
    path_.stop();
    altitude_offset_m_ = 0.0;
    control_.take_over(follower_->trim_W());
  }
  if (control.phase == Phase::kLanded) flown_ = true;
}

ControllerCommand FlightManager::follow(double t_s, const State& state) {
  const AttitudeView& attitude = control_.attitude();
  const Vector3 offset_W{0.0, 0.0, -altitude_offset_m_};
  const PathManager::Output path = path_.step(t_s, state.p_W - offset_W, attitude.psi_rad);
  if (path.event != PathManager::Event::kNone && !returning_) {
    const bool reached = path.event == PathManager::Event::kReached;
    out_.events.add(reached ? FlightEventType::kWaypointReached : FlightEventType::kWaypointMissed,
                    path.event_waypoint, path.event_distance_m);
  }
  if (path.done && returning_) {
    control_.request_land();
  } else if (path.done && !out_.mission_done) {
    out_.mission_done = true;
    out_.events.add(FlightEventType::kMissionDone);
    if (at_end_ == AtEnd::kLand) control_.request_land();
  }
  out_.setpoint = path.setpoint;
  out_.setpoint.p_W += offset_W;
  if (!returning_) out_.waypoint = path.waypoint;
  out_.distance_m = path.distance_m;
  return follower_->step({state, attitude, out_.setpoint, 0.0, control_.dt_s(), control_.pilot()});
}

/// Up to the height of the return where it is lower, down into the fence where it is higher, then above the start.
void FlightManager::begin_return(double t_s, const State& state) {
  altitude_offset_m_ = 0.0;
  path_.set_cycle(false);
  path_.set_waypoints(path_back(state.p_W, start_W_, config_.return_height_m,
                                return_ceiling_m(fence_), control_.attitude().psi_rad));
  if (control_.output().phase == Phase::kOffboard) start_path(t_s, state);
  returning_ = true;
  out_.events.add(FlightEventType::kReturning);
}

/// What battery, fence, position and the caller ask for.
void FlightManager::decide(const Input& in) {
  const bool flying = !control_.on_ground() && control_.output().phase != Phase::kTakeoff;
  if (!flying) return;
  const double dt_s = control_.dt_s();
  const Vector3 nowhere = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  limits_.step(in.status, in.state.horizontal ? Vector3(in.state.p_W - start_W_) : nowhere, dt_s,
               out_.events);
  const bool placed = in.state.horizontal;
  const bool was_placed = unplaced_s_ < kPositionWait_s;
  unplaced_s_ = placed ? 0.0 : unplaced_s_ + dt_s;
  if (was_placed && unplaced_s_ >= kPositionWait_s) {
    out_.events.add(FlightEventType::kPositionLost);
    control_.request_land();
  }
  if (limits_.asks_land()) control_.request_land();
  const bool after_gap = gap_returns_ && in.t_s >= hold_until_s_;
  const bool wanted = return_asked_ || limits_.asks_return() || after_gap;
  if (wanted && !returning_ && placed && control_.output().phase != Phase::kLanding) {
    begin_return(in.t_s, in.state);
  }
}

/// In the air, while no one else flies. A landing ends the watch before the ground pushes.
void FlightManager::watch_rotors(const Input& in) {
  const Phase phase = control_.output().phase;
  const bool high = phase != Phase::kLanding || in.range_m.value_or(kInfinity) > kWatchHeight_m;
  const bool flying = !control_.on_ground() && phase != Phase::kTakeoff;
  if (!flying || !high || control_.pilot().any() || in.status.failsafe) {
    rotors_.interrupt();
    return;
  }
  const bool found = rotors_.step({.outputs = in.outputs,
                                   .w_B = in.state.w_B,
                                   .v_B = in.state.q_WB.conjugate() * in.state.v_W,
                                   .voltage_V = in.status.battery_voltage_V,
                                   .dt_s = control_.dt_s()});
  const std::optional<std::size_t> lost = rotors_.lost();
  if (!found || !lost) return;
  out_.events.add(FlightEventType::kMotorOut, *lost);
  control_.configure(controller_config(), with_height(config_.states, takeoff_height_m_));
  control_.request_land();
}

ControllerConfig FlightManager::controller_config() const {
  ControllerConfig config = config_.controller;
  if (rotors_.lost()) config.max_tilt_rad = std::min(config.max_tilt_rad, kLostTilt_rad);
  return config;
}

void FlightManager::give_up_yaw(const State& state) {
  FirmwareCommand& command = out_.command;
  const bool torque = command.mode == FirmwareMode::kPassThrough;
  out_.yaw_rate_rad_s = torque ? 0.0 : state.w_B.z();
  command.u[5] = static_cast<float>(out_.yaw_rate_rad_s);
}

bool FlightManager::position_settled(const Input& in) {
  const bool aided = in.state.horizontal && in.state.aided;
  if (!aided && !control_.on_ground()) settled_s_ = in.t_s + kPositionSettles_s;
  return aided && in.t_s >= settled_s_;
}

/// What it takes to sink later without a state: the vertical part of the thrust in flight without a climb.
void FlightManager::learn_hover_thrust(const State& state) {
  constexpr double kMean_s = 4.0;
  constexpr double kLevel_m_s = 0.5;
  const Phase phase = control_.output().phase;
  const bool flying = phase == Phase::kPositionHold || phase == Phase::kOffboard;
  if (!flying || control_.pilot().any() || std::abs(state.v_W.z()) > kLevel_m_s) return;
  const Quaternion& q = state.q_WB;
  const double tilt_cosine = 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y());
  hover_thrust_N_ +=
      (out_.thrust_N * tilt_cosine - hover_thrust_N_) * std::min(control_.dt_s() / kMean_s, 1.0);
}

/// The vehicle can be guided again, after a time in which it could not be: GapWatch.
void FlightManager::end_gap(const Input& in) {
  const CommandedFlight::Output& control = control_.output();
  if (sinking_ && control.phase == control.before) {
    out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(control.phase));
  }
  sinking_ = false;
  known_ = in.state;
  const double gap_s = gap_.step(in.t_s, true, in.status.silent_s);
  if (!in.status.armed) rests_ = false;
  if (gap_s <= GapWatch::kGoesOn_s || !in.status.armed || rests_) return;
  if (control.phase == Phase::kDisarmed || control.phase == Phase::kLanded) return;
  out_.events.add(FlightEventType::kLongGap);
  if (control.phase == Phase::kTakeoff) return control_.request_land();
  gap_returns_ = true;
  hold_until_s_ = in.t_s + GapWatch::kHold_s;
}

void FlightManager::enter_without_state(Phase phase) {
  if (out_.phase == phase) return;
  out_.phase = phase;
  out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(phase));
}

/// It stands: motors idle until it is disarmed.
void FlightManager::rest() {
  if (!rests_ && control_.output().phase <= Phase::kTakeoff) {
    out_.events.add(FlightEventType::kTakeoffFailed);
  }
  rests_ = flown_ = out_.landed = out_.request_disarm = true;
  out_.tracking = false;
  out_.command = FirmwareCommand{};
  out_.thrust_N = out_.roll_rad = out_.pitch_rad = out_.yaw_rate_rad_s = 0.0;
  enter_without_state(Phase::kLanded);
}

/// Armed on the ground, and no state to take off with.
void FlightManager::wait_on_ground(const Input& in) {
  out_.command = FirmwareCommand{};
  if (control_.output().phase != Phase::kLanded && gap_.lasts_s(in.t_s) > kTakeoffWait_s) rest();
}

void FlightManager::sink(const Input& in) {
  if (!sinking_) {
    sinking_ = true;
    const StateMachine& machine = control_.machine();
    const bool pilot_flew = gap_.linked_s(in.t_s) < gap_.lasts_s(in.t_s);
    sink_.start(config_.states.landing, {.height_m = machine.ground_down_m() - known_.p_W.z(),
                                         .down_speed_m_s = pilot_flew ? 0.0 : known_.v_W.z(),
                                         .hover_thrust_N = hover_thrust_N_,
                                         .gravity_m_s2 = config_.controller.gravity_m_s2,
                                         .standing_range_m = machine.standing_range_m()});
    out_.events.add(FlightEventType::kSinksLevel);
    enter_without_state(Phase::kLanding);
  }
  const LevelSink::Output down = sink_.step(in.raw, in.range_m, control_.dt_s());
  if (down.touched) return rest();
  out_.command = FirmwareCommand{};
  out_.command.mode = FirmwareMode::kRollPitchYawrateThrottle;
  out_.command.u[2] =
      static_cast<float>(config_.thrust.throttle(down.thrust_N, in.status.battery_voltage_V));
  out_.thrust_N = down.thrust_N;
  out_.roll_rad = out_.pitch_rad = out_.yaw_rate_rad_s = 0.0;
  if (rotors_.yaw_lost() && in.raw.w_B) {
    out_.yaw_rate_rad_s = in.raw.w_B->z();
    out_.command.u[5] = static_cast<float>(out_.yaw_rate_rad_s);
  }
}

/// After the grace: the pilot has the vehicle while the link is silent; with a link it comes down.
void FlightManager::without_state(const Input& in) {
  rotors_.interrupt();
  if (!in.status.armed) {
    rests_ = rests_ || !control_.on_ground();
    return;
  }
  if (rests_) return rest();
  if (gap_.linked_s(in.t_s) < kStateGrace_s) return sink_.interrupt();
  const bool lifted =
      control_.machine().ground_down_m() - known_.p_W.z() > config_.states.lift_off_height_m;
  const bool stands =
      control_.on_ground() || (control_.output().phase == Phase::kTakeoff && !lifted);
  if (stands) return wait_on_ground(in);
  sink(in);
}

const FlightOutput& FlightManager::step(const Input& in) {
  using Turn = CommandedFlight::Turn;
  if (!control_.started()) gap_.start(in.t_s);
  const bool settled = position_settled(in) && !(in.t_s < hold_until_s_);
  const Turn turn =
      control_.begin({.t_s = in.t_s,
                      .state = in.state,
                      .status = in.status,
                      .ready = !flown_,
                      .command_good = command_good_ && settled,
                      .planned = near_plan(in.state, out_.setpoint) ? &out_.setpoint : nullptr,
                      .range_m = in.range_m});
  const CommandedFlight::Output& control = control_.output();
  out_.events = control.events;
  if (turn == Turn::kNone) {
    const bool time_stood = !(control_.dt_s() > 0.0);
    if (time_stood && control_.state_lost()) return out_;
    out_.command = control.command;
    out_.tracking = control.tracking;
    if (time_stood) return out_;
    gap_.step(in.t_s, false, in.status.silent_s);
    if (control_.state_lost()) without_state(in);
    return out_;
  }
  end_gap(in);
  learn_hover_thrust(in.state);
  if (rests_) {
    rest();
    return out_;
  }
  if (control.phase != control.before) hand_over(in.t_s, in.state);
  watch_rotors(in);
  decide(in);
  out_.phase = control.phase;
  out_.tracking = control.tracking && !returning_;
  out_.request_disarm = control.request_disarm;
  out_.landed = control.landed || flown_;
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
  if (rotors_.yaw_lost() && turn != Turn::kIdle) give_up_yaw(in.state);
  return out_;
}

}  // namespace rosflight::autonomy::multirotor
