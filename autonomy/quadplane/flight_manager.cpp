// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/flight_manager.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/common/gap_watch.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

using fixedwing::along;
using fixedwing::right_of;
using P = Conditions;

constexpr double kWindAverage_s = 3.0;
constexpr double kLead_s = 2.5;
constexpr double kNoWind_m_s = 2.0;    // slower air does not say where the nose belongs
constexpr double kNoseAway_rad = 1.0;  // with the nose further off the speed waits
constexpr double kMaxCorrection_m_s = 4.0;
constexpr double kArrived_m = 1.0;
constexpr double kArrivedSlow_m_s = 0.7;
constexpr double kSettle_s = 2.0;
constexpr double kEndGain_1_s = 0.4;
constexpr double kSpoolUp_s = 0.8;
constexpr double kRests_s = 1.5;
constexpr double kLow_m = 1.0;
constexpr double kMoves_m_s = 3.0;    // slower, a path begins straight
constexpr double kReturnSlope = 0.1;  // the steepest part of a return
constexpr double kRollLead_s = 0.3;   // what bank lags behind its command
constexpr std::uint16_t kFreeAxes = 0x3C0;

}  // namespace

FlightManager::FlightManager(const FlightConfig& config, const Mission& mission)
    : config_{config}, mission_{mission}, controller_{config}, landing_{config.landing} {
  hover_thrust_N_ = config.vehicle.mass_kg * config.vehicle.gravity_m_s2;
}

double FlightManager::cruise_over_ground(double course_rad) const {
  const double with = wind_W_.dot(along(course_rad));
  const double across = wind_W_.dot(right_of(course_rad));
  const double v = config_.cruise_m_s;
  return std::max(1.0, with + std::sqrt(std::max(v * v - across * across, 0.0)));
}

/// Against the air that a velocity over ground meets.
double FlightManager::heading_for(const Eigen::Vector2d& v_W) const {
  const Eigen::Vector2d air = v_W - wind_W_;
  return air.norm() < kNoWind_m_s ? controller_.heading_rad() : fixedwing::course_of(air);
}

void FlightManager::take_off(const Input& in) {
  home_W_ = in.state.p_W;
  wind_W_ = in.state.wind_W.head<2>();
  hold_W_ = home_W_ - mission_.takeoff_height_m * Vector3::UnitZ();
  goal_W_ = mission_.waypoints_W.back();
  std::vector<Vector3> points{hold_W_};
  points.insert(points.end(), mission_.waypoints_W.begin(), mission_.waypoints_W.end());
  static_cast<void>(path_.build(points, mission_.turn_radius_m));
  limits_.start(config_.battery, mission_.fence);
  gaps_.start(in.t_s);
}

/// The start, at a height that is reached at a gentle slope.
Vector3 FlightManager::start_goal(const Vector3& p_W) const {
  const double most_m = kReturnSlope / 1.5 * (home_W_ - p_W).head<2>().norm();
  const double height_m = home_W_.z() - p_W.z();
  const double wanted_m = std::min(mission_.takeoff_height_m, return_ceiling_m(mission_.fence));
  return home_W_ - std::clamp(wanted_m, height_m - most_m, height_m + most_m) * Vector3::UnitZ();
}

/// A path from here, as aim_ says.
void FlightManager::plan(const StateEstimate& state) {
  const Vector3& p_W = state.p_W;
  const Eigen::Vector2d v_W = state.v_W.head<2>();
  const double speed = v_W.norm();
  const bool moves = speed > kMoves_m_s;
  const double course = moves ? fixedwing::course_of(v_W) : heading_of(state.q_WB);
  if (aim_ == Aim::kMission) {
    path_.rejoin(p_W);
  } else if (aim_ == Aim::kHere) {
    goal_W_ = p_W;
    goal_W_.head<2>() +=
        (0.5 * speed * speed / config_.deceleration_m_s2 + kArrived_m) * along(course);
    path_.go_to(p_W, course, 0.0, goal_W_);
  } else {
    Vector3 from_W = p_W;
    from_W.z() = std::max(from_W.z(), home_W_.z() - return_ceiling_m(mission_.fence));
    goal_W_ = start_goal(from_W);
    path_.go_to(from_W, course, moves ? mission_.turn_radius_m : 0.0, goal_W_);
  }
  u_m_s_ = std::max(0.0, v_W.dot(along(path_.follow(p_W).course_rad)));
  u_rate_m_s2_ = 0.0;
}

/// @returns true: the path leads somewhere else from now on.
bool FlightManager::change_aim(const Input& in) {
  const Aim aim = land_ ? Aim::kHere : return_ ? Aim::kStart : Aim::kMission;
  const bool flies =
      phase_ == Phase::kTransition || phase_ == Phase::kCruise || phase_ == Phase::kBack;
  if (aim == aim_ || !flies) return false;
  aim_ = aim;
  if (aim_ == Aim::kStart) out_.events.add(FlightEventType::kReturning);
  plan(in.state);
  return true;
}

void FlightManager::enter(Phase phase, const Input& in) {
  const Phase before = phase_;
  phase_ = phase;
  since_s_ = in.t_s;
  out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(phase));
  if (before == Phase::kPilot && phase != Phase::kLanded) {
    controller_.reset(in.state);
    out_.events.add(FlightEventType::kPilotGaveBack);
  }
  switch (phase) {
    case Phase::kTakeoff:
      if (before == Phase::kPilot) {
        since_s_ -= kSpoolUp_s;  // the rotors turn
        break;
      }
      controller_.reset(in.state);
      take_off(in);
      break;
    case Phase::kTransition:
    case Phase::kBack:
      if (before == Phase::kPilot || before == Phase::kTakeoff) plan(in.state);
      begun_ = true;
      break;
    case Phase::kHover:
      hold_W_ = goal_W_;
      if (aim_ != Aim::kMission) break;
      out_.events.add(FlightEventType::kWaypointReached, mission_.waypoints_W.size() - 1,
                      (in.state.p_W - hold_W_).norm());
      out_.events.add(FlightEventType::kMissionDone);
      out_.mission_done = true;
      break;
    case Phase::kLanding:
      if (before != Phase::kHover) hold_W_ = in.state.p_W;
      touching_ = {};
      landing_.start();
      break;
    case Phase::kLanded:
      out_.landed = true;
      break;
    case Phase::kPilot:
      out_.events.add(FlightEventType::kPilotTookOver);
      break;
    case Phase::kDisarmed:
    case Phase::kCruise:
      break;
  }
}

/// Whether commands can be computed and arrive. After a long gap it returns.
bool FlightManager::guided(const Input& in) {
  const bool good =
      in.state.p_W.allFinite() && in.state.v_W.allFinite() && GapWatch::linked(in.status.silent_s);
  const bool flies = phase_ != Phase::kDisarmed && phase_ != Phase::kLanded;
  if (flies && gaps_.step(in.t_s, good, in.status.silent_s) > GapWatch::kGoesOn_s) {
    out_.events.add(FlightEventType::kLongGap);
    return_ = true;
  }
  return good;
}

PhaseConditions FlightManager::conditions(const Input& in) {
  const StateEstimate& state = in.state;
  const bool good = guided(in);
  const bool pilot =
      overrides_.step(in.status.rc_override, dt_s_).any() || !good || in.status.failsafe;
  PhaseConditions now;
  now.set(P::kArmed, in.status.armed);
  now.set(P::kPilot, pilot);
  now.set(P::kLandAsked, land_);
  now.set(P::kReturnAsked, return_);
  now.set(P::kBegun, begun_);
  if (!good) return now;
  now.set(P::kNewPath, change_aim(in));
  const double height_m = home_W_.z() - state.p_W.z();
  now.set(P::kUp, height_m > mission_.takeoff_height_m - 1.0);
  now.set(P::kLow, height_m < kLow_m);
  const double wing_only_m_s = config_.wing_only_stalls * config_.vehicle.stall_speed_m_s();
  now.set(P::kWingborne, out_.airspeed_m_s > wing_only_m_s && out_.lift_force_N <= 0.0);
  const double left_m = path_.empty() ? kInfinity : path_.follow(state.p_W).left_m;
  const double stop_m = 0.5 * u_m_s_ * u_m_s_ / config_.deceleration_m_s2;
  now.set(P::kBraking, left_m < stop_m || left_m < kArrived_m);
  const Vector3 from_end = state.p_W - goal_W_;
  const bool settled =
      from_end.head<2>().norm() < kArrived_m && state.v_W.head<2>().norm() < kArrivedSlow_m_s;
  now.set(P::kArrived, settled && (phase_ != Phase::kHover || in.t_s - since_s_ > kSettle_s));
  now.set(P::kTouched, touching_.touched);
  const bool low = height_m < kLow_m && state.v_W.norm() < 0.3;
  rests_s_ = phase_ == Phase::kPilot && low ? rests_s_ + dt_s_ : 0.0;
  now.set(P::kRests, rests_s_ > kRests_s);
  return now;
}

/// Holds hold_W_, or comes down below it.
Controller::Command FlightManager::hold(const Input& in, double down_m_s) const {
  Vector3 v_W = config_.position_1_s * (hold_W_ - in.state.p_W);
  const double speed = v_W.head<2>().norm();
  if (speed > kMaxCorrection_m_s) v_W.head<2>() *= kMaxCorrection_m_s / speed;
  v_W.z() = down_m_s;
  return {.v_W = v_W, .heading_rad = heading_for({0.0, 0.0})};
}

Controller::Command FlightManager::along_path(const Input& in, const Path::Point& at) {
  const Eigen::Vector2d t_W = along(at.course_rad);
  const double braking = std::sqrt(2.0 * config_.deceleration_m_s2 * std::max(at.left_m, 0.0));
  const double target = std::min(
      {cruise_over_ground(at.course_rad), braking, kEndGain_1_s * std::max(at.left_m, 0.0)});
  const double ahead = std::max(u_m_s_ + kLead_s * u_rate_m_s2_, 0.0);
  const double heading = heading_for(ahead * t_W);
  const double away = std::abs(wrap_angle(heading - heading_of(in.state.q_WB)));
  const double up = away > kNoseAway_rad ? 0.0 : config_.acceleration_m_s2;
  const double before = u_m_s_;
  u_m_s_ =
      std::clamp(target, u_m_s_ - 2.0 * config_.deceleration_m_s2 * dt_s_, u_m_s_ + up * dt_s_);
  const double rate = dt_s_ > 0.0 ? (u_m_s_ - before) / dt_s_ : 0.0;
  u_rate_m_s2_ += std::min(1.0, dt_s_ / 0.5) * (rate - u_rate_m_s2_);

  const Vector3 off_W = at.p_W - in.state.p_W;
  Eigen::Vector2d back = config_.position_1_s * off_W.head<2>();
  if (back.norm() > kMaxCorrection_m_s) back *= kMaxCorrection_m_s / back.norm();
  Controller::Command out{.heading_rad = heading};
  out.v_W.head<2>() = u_m_s_ * t_W + back;
  out.v_W.z() = std::clamp(config_.vertical_1_s * off_W.z(), -3.0, 3.0) - at.slope * u_m_s_;
  const double u = in.state.v_W.head<2>().dot(t_W);
  const double curvature_1_m = path_.curvature_ahead(kRollLead_s * u);
  out.a_ff_W.head<2>() = rate * t_W + u * u * curvature_1_m * right_of(at.course_rad);
  out.a_ff_W.z() = -u * u * at.bend_1_m;
  return out;
}

/// The distance from the path counts where the path is next to the waypoint; the next one is flown to from the end of the
/// corner on.
void FlightManager::report_passing(const Path::Point& at, const Vector3& p_W) {
  const std::size_t before = out_.waypoint;
  if (at.before_m > 0.0) passed_m_ = (p_W - at.p_W).norm();
  if (at.waypoint > before) {
    out_.events.add(FlightEventType::kWaypointReached, before, passed_m_);
  }
  out_.waypoint = at.waypoint;
}

void FlightManager::follow_path(const Input& in, Controller::Command& command) {
  const Path::Point& at = path_.follow(in.state.p_W);
  const bool mission = aim_ == Aim::kMission;
  if (mission) report_passing(at, in.state.p_W);
  command = along_path(in, at);
  out_.tracking = mission;
  out_.setpoint.p_W = at.p_W;
  out_.setpoint.v_W << u_m_s_ * along(at.course_rad), -at.slope * u_m_s_;
  out_.setpoint.psi_rad = at.course_rad;
}

void FlightManager::fly(const Input& in) {
  const StateEstimate& state = in.state;
  const double height_m = home_W_.z() - state.p_W.z();
  out_.tracking = false;
  out_.setpoint = {};
  Controller::Command command{.heading_rad = controller_.heading_rad()};
  switch (phase_) {
    case Phase::kDisarmed:
    case Phase::kLanded:
      out_.command = FirmwareCommand{};
      return;
    case Phase::kPilot:
      if (!state.p_W.allFinite() || !state.v_W.allFinite()) {
        out_.command = FirmwareCommand{};
        out_.command.ignore = kIgnoreAll;
        return;
      }
      controller_.reset(state);
      command.v_W.head<2>() = state.v_W.head<2>();
      command.heading_rad = controller_.heading_rad();
      break;
    case Phase::kTakeoff: {
      if (in.t_s - since_s_ < kSpoolUp_s) {
        out_.command = FirmwareCommand{};
        return;
      }
      const double left_m = state.p_W.z() - hold_W_.z();
      command =
          hold(in, -std::clamp(config_.vertical_1_s * left_m, 0.3, config_.takeoff_speed_m_s));
      command.on_ground = height_m < 0.3;
      out_.setpoint.p_W = {home_W_.x(), home_W_.y(), state.p_W.z()};
      break;
    }
    case Phase::kTransition:
    case Phase::kCruise:
    case Phase::kBack:
      follow_path(in, command);
      break;
    case Phase::kHover:
      command =
          hold(in, std::clamp(config_.vertical_1_s * (hold_W_.z() - state.p_W.z()), -2.0, 2.0));
      out_.setpoint.p_W = hold_W_;
      break;
    case Phase::kLanding: {
      hover_thrust_N_ += std::min(1.0, dt_s_ / 2.0) * (out_.lift_force_N - hover_thrust_N_) *
                         (touching_.unloading || height_m < 1.0 ? 0.0 : 1.0);
      touching_ = landing_.step({.dt_s = dt_s_,
                                 .down_speed_m_s = state.v_W.z(),
                                 .height_m = height_m,
                                 .thrust_N = out_.lift_force_N,
                                 .hover_thrust_N = hover_thrust_N_});
      command = hold(in, touching_.down_speed_m_s);
      if (touching_.unloading) command.lift_force_N = touching_.thrust_N, command.on_ground = true;
      out_.setpoint.p_W = {hold_W_.x(), hold_W_.y(), state.p_W.z()};
      break;
    }
  }
  const double voltage_V = in.status.battery_voltage_V;
  if (voltage_V > 0.0) command.supply = std::min(1.0, voltage_V / config_.vehicle.full_voltage_V);
  const Controller::Output& done = controller_.step(state, command, dt_s_);
  out_.command = done.command;
  if (phase_ == Phase::kPilot) out_.command.ignore = kFreeAxes;
  out_.lift_force_N = done.lift_force_N;
  out_.airspeed_m_s = done.airspeed_m_s;
}

const FlightOutput& FlightManager::step(const Input& in) {
  dt_s_ = std::clamp(in.t_s - t_s_, 0.0, 0.1);
  t_s_ = in.t_s;
  out_.events = {};
  if (in.state.wind_W.allFinite()) {
    wind_W_ += std::min(1.0, dt_s_ / kWindAverage_s) * (in.state.wind_W.head<2>() - wind_W_);
  }
  const Phase next = phase_ == Phase::kDisarmed && out_.landed
                         ? phase_
                         : kPhaseTable.next(phase_, conditions(in).bits());
  if (next != phase_) enter(next, in);
  out_.phase = phase_;
  out_.request_disarm = phase_ == Phase::kLanded;
  if (phase_ != Phase::kDisarmed && phase_ != Phase::kLanded)
    limits_.step(in.status, in.state.p_W - home_W_, dt_s_, out_.events);
  land_ = land_ || limits_.asks_land();
  return_ = return_ || limits_.asks_return();
  fly(in);
  if (!mission_.waypoints_W.empty() && out_.waypoint < mission_.waypoints_W.size())
    out_.distance_m = (in.state.p_W - mission_.waypoints_W[out_.waypoint]).norm();
  return out_;
}

}  // namespace rosflight::autonomy::quadplane
