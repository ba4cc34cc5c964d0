// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/path_manager.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "autonomy/multirotor/angles.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kNearPlan_m = 1.0;  // closer than this a path goes on from its own setpoint
constexpr double kNearPlan_m_s = 0.5;
constexpr double kMinLinear_m = 1e-3;  // a shorter path is a turn on the spot

}  // namespace

void PathManager::set_waypoints(std::vector<Waypoint> waypoints) {
  waypoints_ = std::move(waypoints);
  index_ = 0;
  arrived_ = judged_ = done_ = false;
  replan_ = started_;
  plan_speeds();
}

void PathManager::append(const Waypoint& waypoint) {
  if (waypoints_.empty()) {
    set_waypoints({waypoint});
    return;
  }
  waypoints_.push_back(waypoint);
  done_ = false;
  plan_speeds();
}

void PathManager::configure(const PathConfig& config) {
  config_ = config;
  plan_speeds();
}

void PathManager::plan_speeds() {
  const std::size_t n = waypoints_.size();
  passing_speed_m_s_.assign(n, 0.0);
  if (config_.interpolation != Interpolation::kLinear || n < 2) return;
  const auto leg_m = [&](std::size_t i) {
    return (waypoints_[(i + 1) % n].p_W - waypoints_[i].p_W).norm();
  };
  for (std::size_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n && !config_.cycle;
    const bool stops = last || waypoints_[i].type == WaypointType::kHold || leg_m(i) < kMinLinear_m;
    if (!stops) passing_speed_m_s_[i] = std::min(waypoints_[i].speed_m_s, config_.limits.speed_m_s);
  }
  // Backwards, so that every leg can brake to the speed at its end; twice around closes a cycle.
  for (std::size_t k = 2 * n; k-- > 0;) {
    const std::size_t i = k % n;
    const double next = passing_speed_m_s_[(i + 1) % n];
    const double feasible =
        std::sqrt(next * next + 2.0 * config_.limits.acceleration_m_s2 * leg_m(i));
    if (i + 1 < n || config_.cycle)
      passing_speed_m_s_[i] = std::min(passing_speed_m_s_[i], feasible);
  }
}

void PathManager::start(double t_s, const Trajectory& from) {
  started_ = true;
  replan_ = false;
  speed_m_s_ = 0.0;
  last_s_ = t_s;
  plan_leg(t_s, from);
}

void PathManager::plan_leg(double t_s, const Trajectory& from) {
  last_ = from;
  leg_start_s_ = t_s;
  arrived_ = false;
  leg_end_speed_m_s_ = 0.0;
  if (waypoints_.empty()) {
    leg_ = QuinticLeg(from, from.p_W, from.psi_rad, config_.limits);
    return;
  }
  const Waypoint& target = waypoints_[index_];
  LegLimits limits = config_.limits;
  limits.speed_m_s = std::min(limits.speed_m_s, target.speed_m_s);
  const double leg_m = (target.p_W - from.p_W).norm();
  constexpr double kAtCrossing_m = 0.01;
  if (target.figure_turns > 0 && leg_m < kAtCrossing_m && from.v_W.isZero(1e-6)) {
    leg_ = FigureEightLeg(from, target.figure_radius_m, target.figure_turns,
                          target.figure_course_rad, limits.speed_m_s, limits.acceleration_m_s2);
    return;
  }
  const bool along_path = speed_m_s_ > 0.0 || from.v_W.isZero(0.0);
  if (config_.interpolation == Interpolation::kLinear && along_path && leg_m > kMinLinear_m) {
    const double reachable =
        std::sqrt(speed_m_s_ * speed_m_s_ + 2.0 * limits.acceleration_m_s2 * leg_m);
    const LinearLeg leg(from, target.p_W, target.psi_rad, speed_m_s_,
                        std::min(passing_speed_m_s_[index_], reachable), limits);
    leg_ = leg;
    leg_end_speed_m_s_ = leg.end_speed_m_s();
  } else {
    leg_ = QuinticLeg(from, target.p_W, target.psi_rad, limits);
  }
}

double PathManager::leg_duration_s() const {
  return std::visit([](const auto& leg) { return leg.duration_s(); }, leg_);
}

Trajectory PathManager::leg_sample(double t_s) const {
  return std::visit([&](const auto& leg) { return leg.sample(t_s - leg_start_s_); }, leg_);
}

void PathManager::judge(Event event, double distance_m, Output& out) {
  if (judged_) return;
  judged_ = true;
  out.event = event;
  out.event_waypoint = index_;
  out.event_distance_m = distance_m;
}

void PathManager::advance(double t_s, Output& out) {
  const bool last = index_ + 1 == waypoints_.size();
  if (last && (!config_.cycle || waypoints_.size() == 1)) {
    done_ = !config_.cycle;
    return;
  }
  const Trajectory end = leg_sample(t_s);
  index_ = last ? 0 : index_ + 1;
  judged_ = false;
  speed_m_s_ = leg_end_speed_m_s_;
  plan_leg(t_s, end);
  out.waypoint = index_;
}

PathManager::Output PathManager::step(double t_s, const Vector3& p_W, double psi_rad) {
  if (replan_) {
    replan_ = false;
    speed_m_s_ = 0.0;
    plan_leg(last_s_, Trajectory(last_));
  }
  last_s_ = t_s;
  Output out;
  out.waypoint = index_;
  out.setpoint = leg_sample(t_s);
  last_ = out.setpoint;
  out.done = done_;
  if (waypoints_.empty()) return out;
  const Waypoint& target = waypoints_[index_];
  out.distance_m = (target.p_W - p_W).norm();
  const double waited_s = t_s - leg_start_s_ - leg_duration_s();
  if (waited_s < 0.0) return out;

  const bool near = out.distance_m <= config_.waypoint_tolerance_m;
  if (leg_end_speed_m_s_ > 0.0) {
    judge(near ? Event::kReached : Event::kMissed, out.distance_m, out);
    advance(leg_start_s_ + leg_duration_s(), out);  // on time, not on the next step
    out.setpoint = last_ = leg_sample(t_s);
    return out;
  }
  if (!arrived_) {
    const bool facing =
        std::abs(wrap_angle(target.psi_rad - psi_rad)) <= config_.heading_tolerance_rad;
    if (!(near && facing) && waited_s < config_.arrival_timeout_s) return out;
    arrived_ = true;
    arrival_s_ = t_s;
    judge(near && facing ? Event::kReached : Event::kMissed, out.distance_m, out);
  }
  const bool hold = target.type == WaypointType::kHold;
  const bool stay = hold && (target.hold_indefinitely || t_s - arrival_s_ < target.hold_s);
  if (!stay) advance(t_s, out);
  out.done = done_;
  return out;
}

bool near_plan(const State& state, const Trajectory& setpoint) {
  return (setpoint.p_W - state.p_W).squaredNorm() < kNearPlan_m * kNearPlan_m &&
         (setpoint.v_W - state.v_W).squaredNorm() < kNearPlan_m_s * kNearPlan_m_s;
}

Trajectory path_start(const State& state, double psi_rad, const Trajectory& setpoint) {
  Trajectory from;
  if (near_plan(state, setpoint)) {
    from.p_W = setpoint.p_W;
    from.psi_rad = wrap_angle(setpoint.psi_rad);
  } else {
    from.p_W = state.p_W;
    from.v_W = state.v_W;
    from.psi_rad = psi_rad;
  }
  return from;
}

std::vector<Waypoint> path_back(const Vector3& from_W, const Vector3& home_W, double height_m,
                                double ceiling_m, double psi_rad) {
  const double down_m =
      std::max(std::min(from_W.z(), home_W.z() - height_m), home_W.z() - ceiling_m);
  Waypoint up;
  up.p_W << from_W.head<2>(), down_m;
  up.psi_rad = psi_rad;
  Waypoint over_home = up;
  over_home.p_W << home_W.head<2>(), down_m;
  return {up, over_home};
}

}  // namespace rosflight::autonomy::multirotor
