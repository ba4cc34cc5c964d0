// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/companion_loops.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "autonomy/fixedwing/flight_manager.hpp"
#include "base/constants.hpp"

namespace rosflight::python {
namespace {

namespace fixedwing = autonomy::fixedwing;
using autonomy::StateEstimate;
using autonomy::multirotor::ControlMode;

/// The course of the first two numbers, or without a direction that of the vehicle.
double course_of(const CompanionLoops::Numbers& a, const StateEstimate& state) {
  constexpr double kNoDirection = 1e-6;
  return std::hypot(a[0], a[1]) > kNoDirection ? std::atan2(a[1], a[0]) : state.course_rad;
}

double length_of(const CompanionLoops::Numbers& a) {
  return std::min(std::hypot(a[0], a[1]), 1.0);
}

}  // namespace

std::unique_ptr<CompanionLoops> CompanionLoops::make(const flight::FlightSetup& setup) {
  if (const auto* wing = std::get_if<flight::FixedWingPlan>(&setup.plan))
    return std::make_unique<FixedWingLoops>(wing->autonomy);
  return std::make_unique<MultirotorLoops>(std::get<flight::MultirotorPlan>(setup.plan).autonomy);
}

MultirotorLoops::MultirotorLoops(const autonomy::multirotor::AutonomyConfig& config)
    : fresh_{config.flight.controller, config.flight.thrust}, controller_{fresh_} {}

void MultirotorLoops::fly_velocity(const Numbers& a, const StateEstimate& /*state*/) {
  const auto& limits = fresh_.config();
  const double vertical = a[2] < 0.0 ? limits.max_climb_m_s : limits.max_descend_m_s;
  const double horizontal = limits.max_horizontal_velocity_m_s;
  wanted_ = {
      ControlMode::kNvelEvelDvelYawrate,
      {horizontal * a[0], horizontal * a[1], vertical * a[2], limits.max_yaw_rate_rad_s * a[3]},
      true};
}

void MultirotorLoops::fly_waypoint(const Numbers& a, const StateEstimate& state) {
  fly_to({state.p_W.x() + kReach_m * a[0], state.p_W.y() + kReach_m * a[1],
          state.p_W.z() + kReach_m * a[2]},
         base::kPi * a[3]);
}

void MultirotorLoops::fly_to(const autonomy::Vector3& p_W, double heading_rad) {
  wanted_ = {ControlMode::kNposEposDposYaw, {p_W.x(), p_W.y(), p_W.z(), heading_rad}, true};
}

autonomy::FirmwareCommand MultirotorLoops::step(const StateEstimate& state, double dt_s,
                                                double battery_voltage_V) {
  autonomy::multirotor::State flown;
  flown.p_W = state.p_W;
  flown.v_W = state.v_W;
  flown.q_WB = state.q_WB;
  flown.w_B = state.w_B;
  const autonomy::multirotor::AttitudeView attitude{state.q_WB};
  return controller_
      .step({.state = flown,
             .attitude = attitude,
             .command = wanted_,
             .dt_s = dt_s,
             .battery_voltage_V = battery_voltage_V})
      .command;
}

FixedWingLoops::FixedWingLoops(const fixedwing::AutonomyConfig& config)
    : config_{config.flight},
      min_airspeed_m_s_{config.mission.min_airspeed_m_s},
      max_airspeed_m_s_{config.mission.max_airspeed_m_s},
      follower_{config.flight.follower},
      controller_{config.flight.controller} {}

void FixedWingLoops::restart() {
  controller_.reset();
  path_.reset();
  wanted_ = {};
  height_m_.reset();
}

void FixedWingLoops::fly_velocity(const Numbers& a, const StateEstimate& state) {
  path_.reset();
  wanted_ = {};
  wanted_.valid = true;
  wanted_.course_rad = course_of(a, state);
  wanted_.airspeed_m_s = min_airspeed_m_s_ + length_of(a) * (max_airspeed_m_s_ - min_airspeed_m_s_);
  const double slope = a[2] < 0.0 ? config_.plan.climb_slope : config_.plan.descent_slope;
  wanted_.climb_ff_m_s = -a[2] * slope * wanted_.airspeed_m_s;
}

void FixedWingLoops::fly_waypoint(const Numbers& a, const StateEstimate& state) {
  const double reach_m = kReachRadii * config_.plan.radius_m;
  const double slope = a[2] < 0.0 ? config_.plan.climb_slope : config_.plan.descent_slope;
  const double course_rad = course_of(a, state);
  const double cruise_m_s = config_.plan.airspeed_m_s;
  fixedwing::CurrentPath path;
  path.valid = true;
  path.airspeed_m_s = cruise_m_s + (a[3] < 0.0 ? a[3] * (cruise_m_s - min_airspeed_m_s_)
                                               : a[3] * (max_airspeed_m_s_ - cruise_m_s));
  path.r_W = state.p_W;
  path.r_W.head<2>() += reach_m * length_of(a) * fixedwing::along(course_rad);
  path.r_W.z() += reach_m * slope * a[2];
  path.q_W << fixedwing::along(course_rad), 0.0;
  path_ = path;
  height_m_.reset();
}

void FixedWingLoops::fly_course(double course_rad, double height_m) {
  path_.reset();
  wanted_ = {};
  wanted_.valid = true;
  wanted_.course_rad = course_rad;
  wanted_.airspeed_m_s = config_.plan.airspeed_m_s;
  height_m_ = height_m;
}

autonomy::FirmwareCommand FixedWingLoops::step(const StateEstimate& state, double dt_s,
                                               double /*battery_voltage_V*/) {
  fixedwing::ControllerCommand command = wanted_;
  if (path_) {
    command = follower_.step(state, *path_, 0.0);
  } else {
    const double now_m = -state.p_W.z();
    double height_m = height_m_.value_or(now_m);
    if (wanted_.climb_ff_m_s != 0.0) {
      height_m = std::clamp(height_m + wanted_.climb_ff_m_s * dt_s, now_m - kMaxLead_m,
                            now_m + kMaxLead_m);
    }
    height_m_ = command.height_m = height_m;
  }
  return fixedwing::command_of(
      controller_
          .step({.state = state, .command = command, .dt_s = dt_s, .pilot = {}, .direct = {}})
          .surfaces);
}

}  // namespace rosflight::python
