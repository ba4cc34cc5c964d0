// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/phase_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/turn_radius.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kNearReference_m = 8.0;  // a path continues from the wanted height within this
constexpr double kCalm_m_s = 1.0;         // less wind than this does not turn the landing round
constexpr double kTooFast_s_m = 0.2;      // throttle taken away per speed above cruise
constexpr double kFlareRamp_1_s = 0.5;    // throttle taken away per second
constexpr double kFlareSlowest = 0.9;     // of the approach airspeed; slower, throttle comes up
constexpr double kFlareThrottle = 4.4;    // per share of airspeed that is missing
constexpr double kFlareSink_s_m = 0.4;    // throttle per sink that is too much,
constexpr double kFlareSink_m_s = 0.3;    // beyond this
constexpr double kNoseDown_m = 0.3;       // higher, the nose may still go down,
constexpr double kNoseDown_rad = 4.0 * kRadPerDeg;  // by this
constexpr double kSameRadius_m = 0.01;
constexpr double kShareOfBank = 0.85;  // of the largest bank, for turns down the wind
constexpr double kPathFirst_m = 10.0;  // lower on an approach pitch holds the path alone
constexpr double kGustMargin = 1.0;    // of the gusts' deviation, on top of a landing's airspeed,
constexpr double kMaxMargin = 0.15;    // at most this share of it;
constexpr double kMoreWithoutMotor = 1.5;  // of both: no throttle makes up for what a gust takes
constexpr double kFinalRoll_rad = 15.0 * kRadPerDeg;  // at the ground on the final part of a glide,
constexpr double kFinalRoll_rad_m = 2.0 * kRadPerDeg;  // and more with the height

double head_wind(const StateEstimate& state, double course_rad) {
  if (!state.wind_valid) return 0.0;
  return -state.wind_W.head<2>().dot(along(course_rad));
}

double radius_of(const PhasePath::Input& in) {
  return in.mission.radius_m.value_or(in.config.plan.radius_m);
}

}  // namespace

Controller::Direct takeoff_direct(const FlightConfig& config, double airspeed_m_s, double since_s,
                                  double course_rad) {
  Controller::Direct out;
  const bool fast = airspeed_m_s > config.takeoff.rotate_m_s;
  out.roll_rad = 0.0;
  out.pitch_rad = fast ? config.takeoff.pitch_rad : 0.0;
  // All there is, but no faster than cruise.
  out.throttle = std::min({since_s / config.takeoff.ramp_s, 1.0,
                           1.0 - kTooFast_s_m * (airspeed_m_s - config.controller.cruise_m_s)});
  if (!fast) out.ground_course_rad = course_rad;
  return out;
}

Vector3 PhasePath::landing_position_W(const Mission& mission) const {
  return {mission.landing.aim_W.x(), mission.landing.aim_W.y(),
          start_W_.z() + mission.landing.aim_W.z()};
}

double PhasePath::flare_height_m(const LandingConfig& config, double sink_m_s) const {
  return std::max(flare_height_m_, config.flare_time_s * (sink_m_s - config.touchdown_m_s));
}

double PhasePath::choose_landing_course(const Input& in) const {
  if (in.mission.landing.course_rad) return *in.mission.landing.course_rad;
  const bool tail_wind = head_wind(in.state, start_course_rad_) < -kCalm_m_s;
  return tail_wind ? wrap_angle(start_course_rad_ + kPi) : start_course_rad_;
}

double PhasePath::in_gusts(double airspeed_m_s) const {
  return airspeed_m_s + gust_margin_m_s(airspeed_m_s);
}

double PhasePath::gust_margin_m_s(double airspeed_m_s) const {
  return std::min(kGustMargin * gusts_.sigma_m_s(), kMaxMargin * airspeed_m_s);
}

double PhasePath::closest_turn_m(const Input& in, double airspeed_m_s) const {
  const double wind_m_s = in.state.wind_valid ? gusts_.mean_m_s() + gusts_.sigma_m_s() : 0.0;
  const ControllerConfig& controller = in.config.controller;
  return closest_turn_radius(airspeed_m_s + wind_m_s, kShareOfBank * controller.max_roll_rad,
                             controller.airframe.gravity_m_s2);
}

std::optional<PlanFault> PhasePath::start(const PlannerConfig& config, const PathStart& from,
                                          std::vector<Waypoint> waypoints, bool cycle,
                                          std::size_t first) {
  path_ = PathManager(config);
  path_.set_waypoints(waypoints, cycle);
  const auto fault = path_.start(from, first);
  const bool corner = waypoints[first].passing == Passing::kFillet && waypoints.size() > 1;
  if (!corner || (!fault && path_.plan().radius_at(first) > config.radius_m - kSameRadius_m))
    return fault;
  // From here its corner is too sharp to be rounded off: over it, already on the next leg.
  const Vector3& next_W = waypoints[(first + 1) % waypoints.size()].p_W;
  waypoints[first].passing = Passing::kDubins;
  waypoints[first].course_rad = course_of((next_W - waypoints[first].p_W).head<2>());
  PathManager over(config);
  over.set_waypoints(std::move(waypoints), cycle);
  if (const auto worse = over.start(from, first)) return fault ? worse : fault;
  path_ = std::move(over);
  return {};
}

void PhasePath::plan(const Input& in, const std::vector<Waypoint>& waypoints, bool cycle,
                     std::size_t first, double radius_m, FlightEvents& events) {
  double height_m = -in.state.p_W.z();
  const auto& wanted_m = in.last.wanted_height_m;
  if (wanted_m && std::abs(*wanted_m - height_m) < kNearReference_m) height_m = *wanted_m;
  const PathStart from{{in.state.p_W.head<2>(), in.state.course_rad}, height_m};
  double airspeed_m_s = in.config.plan.airspeed_m_s;
  for (const Waypoint& wp : waypoints) airspeed_m_s = std::max(airspeed_m_s, wp.airspeed_m_s);
  const double wider_m = std::max(closest_turn_m(in, airspeed_m_s) - radius_m, 0.0);
  PlannerConfig config = in.config.plan;
  std::optional<PlanFault> fault;
  for (const double share : {1.0, 0.5, 0.0}) {  // as wide as there is room for
    config.radius_m = radius_m + share * wider_m;
    config.closest_m = radius_m;
    fault = start(config, from, waypoints, cycle, first);
    if (!fault) return;
  }
  if (fault) events.add(FlightEventType::kPathFault, fault->waypoint);
}

void PhasePath::begin_approach(const Input& in, FlightEvents& events) {
  const double course_rad = choose_landing_course(in);
  LandingConfig config = in.config.landing;
  config.airspeed_m_s = in_gusts(config.airspeed_m_s);
  const LandingPath landing =
      LandingPath::plan(config, landing_position_W(in.mission), course_rad,
                        in.config.plan.airspeed_m_s, head_wind(in.state, course_rad));
  flare_height_m_ = landing.flare_height_m;
  plan(in, {landing.waypoints.begin(), landing.waypoints.end()}, false, 0, in.config.plan.radius_m,
       events);
}

void PhasePath::circle_here(const Input& in) {
  const double radius_m = std::max(radius_of(in), closest_turn_m(in, in.config.plan.airspeed_m_s));
  circle_ = {};
  circle_.valid = true;
  circle_.circle = true;
  circle_.airspeed_m_s = in.config.plan.airspeed_m_s;
  circle_.radius_m = radius_m;
  circle_.c_W << in.state.p_W.head<2>() + radius_m * right_of(in.state.course_rad),
      std::min(in.state.p_W.z(), start_W_.z() - in.config.takeoff.airborne_m);
}

void PhasePath::begin(Phase phase, std::size_t waypoint, const Input& in, FlightEvents& events) {
  since_s_ = in.t_s;
  switch (phase) {
    case Phase::kTakeoff:
      start_W_ = climb_from_W_ = in.state.p_W;
      start_course_rad_ = heading_of(in.state.q_WB);
      break;
    case Phase::kMission:
      plan(in, in.mission.waypoints, in.mission.at_end == AtEnd::kCycle, waypoint, radius_of(in),
           events);
      break;
    case Phase::kReturn: {
      Waypoint home;
      const double up_m =
          std::min(in.config.safety.return_height_m, return_ceiling_m(in.mission.fence));
      home.p_W = start_W_ - Vector3(0.0, 0.0, up_m);
      home.passing = Passing::kCircle;
      home.hold_indefinitely = true;
      plan(in, {home}, false, 0, radius_of(in), events);
      break;
    }
    case Phase::kApproach:
      begin_approach(in, events);
      break;
    case Phase::kLoiter:
      circle_here(in);
      break;
    case Phase::kDescent:
      circle_here(in);
      circle_.airspeed_m_s =
          in_gusts(std::max(in.config.landing.airspeed_m_s, in.config.safety.glide_m_s));
      circle_.slope = -in.config.safety.descent_m_s / circle_.airspeed_m_s;
      path_.stop();
      break;
    case Phase::kGlide:
      circle_here(in);
      glide_.begin(glide_input(in), path_);
      break;
    case Phase::kFlare:
      flare_throttle_ = in.motor_lost ? 0.0 : in.last.throttle;
      break;
    case Phase::kRollout:
      // In a crosswind the nose points beside the way over the ground.
      roll_course_rad_ = in.position_lost ? heading_of(in.state.q_WB) : in.state.course_rad;
      break;
    case Phase::kClimb:
      climb_from_W_ = in.state.p_W;
      break;
    case Phase::kLanded:
    case Phase::kDisarmed:
      break;
  }
}

void PhasePath::restart(Phase phase, const Input& in) {
  if (phase == Phase::kLoiter) circle_here(in);
  if (phase != Phase::kTakeoff) return;
  start_W_ = in.state.p_W;
  start_course_rad_ = heading_of(in.state.q_WB);
  since_s_ = in.t_s;
}

GlideFlight::Input PhasePath::glide_input(const Input& in) const {
  return {
      .t_s = in.t_s,
      .dt_s = in.t_s - stepped_s_,
      .state = in.state,
      .config = in.config,
      .landing = {landing_position_W(in.mission), choose_landing_course(in)},
      .start = {start_W_, {}},
      .radius_m = std::max(in.config.plan.radius_m, closest_turn_m(in, in.config.safety.glide_m_s)),
      .airspeed_m_s = in.config.safety.glide_m_s +
                      kMoreWithoutMotor * gust_margin_m_s(in.config.safety.glide_m_s),
      .position_lost = in.position_lost};
}

/// The line of the take-off; from where it is airborne it climbs.
CurrentPath PhasePath::straight_on(Phase phase, const FlightConfig& config) const {
  CurrentPath out;
  out.valid = true;
  out.airspeed_m_s = config.plan.airspeed_m_s;
  out.r_W = start_W_;
  out.r_W.z() = climb_from_W_.z();
  out.q_W << along(start_course_rad_), 0.0;
  if (phase == Phase::kClimb) {
    const Vector2 flown = (climb_from_W_ - start_W_).head<2>();
    out.r_W.head<2>() += flown.dot(along(start_course_rad_)) * along(start_course_rad_);
    out.q_W.z() = -config.plan.climb_slope;
    out.q_W.normalize();
  }
  return out;
}

/// Ramped down to its end; beyond that by the airspeed, and more for a sink that the flare must not
/// have: a gust that ends takes lift which only speed brings back.
double PhasePath::flare_throttle(const Input& in, double airspeed_m_s) const {
  if (in.motor_lost) return 0.0;
  const LandingConfig& landing = in.config.landing;
  const double speed = airspeed_m_s / landing.airspeed_m_s;
  const double missing = std::max(kFlareSlowest - speed, 0.0) - std::max(speed - 1.0, 0.0);
  const double sink_m_s = in.state.v_W.z() + flare_climb(landing, in.height_above_ground_m);
  const double held = landing.flare_throttle + kFlareThrottle * missing +
                      kFlareSink_s_m * std::max(sink_m_s - kFlareSink_m_s, 0.0);
  const double ramp = flare_throttle_ - kFlareRamp_1_s * since_s(in.t_s);
  return std::clamp(held, std::clamp(ramp, 0.0, 1.0), 1.0);
}

Controller::Direct PhasePath::direct(Phase phase, const Input& in) const {
  Controller::Direct out;
  const FlightConfig& config = in.config;
  const double v = in.state.air_valid ? in.state.airspeed_m_s : in.state.v_W.head<2>().norm();
  switch (phase) {
    case Phase::kTakeoff:
      return takeoff_direct(config, v, since_s(in.t_s), start_course_rad_);
    case Phase::kLoiter:
      if (in.position_lost) out.roll_rad = config.controller.lost_roll_rad;
      break;
    case Phase::kDescent:
      out.roll_rad = in.height_above_ground_m < config.safety.straight_below_m
                         ? 0.0
                         : config.controller.lost_roll_rad;
      if (in.height_above_ground_m < kPathFirst_m) out.speed_share = 0.0;
      break;
    case Phase::kGlide:
      out.airspeed_by_pitch_m_s = glide_.airspeed_m_s(glide_input(in));
      if (in.height_above_ground_m < config.safety.straight_below_m) {
        if (glide_.planned() && !in.position_lost) {
          out.max_roll_rad = kFinalRoll_rad + kFinalRoll_rad_m * in.height_above_ground_m;
        } else {
          out.roll_rad = 0.0;
        }
      } else if (in.position_lost) {
        out.roll_rad = config.controller.lost_roll_rad;
      }
      break;
    case Phase::kApproach:
      if (in.height_above_ground_m < kPathFirst_m) out.speed_share = 0.0;
      break;
    case Phase::kFlare:
      out.climb_m_s = flare_climb(config.landing, in.height_above_ground_m);
      out.throttle = flare_throttle(in, v);
      out.max_roll_rad = config.landing.max_roll_rad;
      out.max_pitch_rad = config.landing.max_pitch_rad;
      out.min_pitch_rad = in.height_above_ground_m > kNoseDown_m ? -kNoseDown_rad : 0.0;
      if (!path_.started() || in.position_lost) out.roll_rad = 0.0;
      break;
    case Phase::kRollout:
      out.roll_rad = 0.0;
      out.pitch_rad = 0.0;
      out.throttle = 0.0;
      out.ground_course_rad = roll_course_rad_;
      break;
    default:
      break;
  }
  return out;
}

PhasePath::Output PhasePath::step(Phase phase, const Input& in) {
  Output out;
  gusts_.step(in.state, std::min(in.t_s - stepped_s_, 0.2));
  switch (phase) {
    case Phase::kDescent:
      circle_.c_W.z() += in.config.safety.descent_m_s * std::clamp(in.t_s - stepped_s_, 0.0, 0.2);
      out.follow = circle_;
      break;
    case Phase::kGlide:
      out.follow = glide_.step(glide_input(in), path_);
      out.planned = path_.started();
      break;
    case Phase::kFlare:
      if (!path_.started()) {
        out.follow = circle_;
        break;
      }
      [[fallthrough]];
    case Phase::kMission:
    case Phase::kReturn:
    case Phase::kApproach:
      out.planned = true;
      out.follow = path_.step(in.state.p_W, in.config.lead_s * in.state.v_W.head<2>().norm()).path;
      break;
    case Phase::kTakeoff:
    case Phase::kClimb:
    case Phase::kRollout:
      out.follow = straight_on(phase, in.config);
      break;
    default:
      out.follow = circle_;
      break;
  }
  stepped_s_ = in.t_s;
  out.direct = direct(phase, in);
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
