// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/guidance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kNearReference_m = 8.0;  // closer than this a path goes on from the reference
constexpr double kCalm_m_s = 1.0;         // less wind than this does not turn the landing round
constexpr double kStill_m_s = 1.0;
constexpr double kStill_s = 1.0;
constexpr double kTouch_m_s = 0.2;  // sink that tells rolling from sinking
constexpr double kTouch_s = 0.4;
constexpr double kTouchHeight_m = 3.0;  // no ground is higher above the believed one
constexpr double kTooTilted = 0.8;      // cosine beyond which a range says little of the height
constexpr double kTooFast_s_m = 0.2;    // throttle taken away per speed above cruise
constexpr double kFlareRamp_1_s = 0.5;  // throttle taken away per second

double heading_of(const Quaternion& q) {
  return std::atan2(2.0 * (q.x() * q.y() + q.w() * q.z()),
                    1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
}

double cos_tilt(const Quaternion& q) {
  return 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y());
}

}  // namespace

const char* name(FlightEventType type) {
  switch (type) {
    case FlightEventType::kPhase:
      return "phase";
    case FlightEventType::kWaypointPassed:
      return "waypoint passed";
    case FlightEventType::kMissionDone:
      return "mission done";
    case FlightEventType::kTakeoffFailed:
      return "take-off failed";
    case FlightEventType::kPathFault:
      return "no path leads on from here";
    case FlightEventType::kMotorOut:
      return "motor out";
    case FlightEventType::kPlaceLost:
      return "position lost";
    case FlightEventType::kPilotTookOver:
      return "pilot took over";
    case FlightEventType::kPilotGaveBack:
      return "pilot gave back";
    case FlightEventType::kStateLost:
      return "state lost";
    case FlightEventType::kStateRegained:
      return "state regained";
  }
  return "unknown";
}

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

Guidance::Guidance(const FlightConfig& config, const Mission& mission) : config_(config) {
  set_mission(mission);
}

void Guidance::set_mission(const Mission& mission, std::size_t first) {
  if (mission.waypoints.empty()) throw std::invalid_argument("the mission has no waypoint");
  mission_ = mission;
  out_.waypoint = std::min(first, mission.waypoints.size() - 1);
  out_.mission_done = path_done_ = land_ = return_ = false;
  if (out_.phase == Phase::kLanded || out_.phase == Phase::kDisarmed) flown_ = false;
  // In flight the new list is planned from where the vehicle is.
  if (out_.phase == Phase::kMission) path_.stop();
}

void Guidance::event(FlightEventType type, std::size_t index, double value) {
  if (out_.event_count == GuidanceOutput::kMaxEvents) return;
  out_.events[out_.event_count++] = {type, index, value};
}

bool Guidance::state_good(const Input& in) {
  const StateEstimate& s = in.state;
  const bool good = s.attitude != Trust::kNone && s.vertical != Trust::kNone &&
                    std::isfinite(s.p_N.sum() + s.v_N.sum() + s.q_NB.coeffs().sum() + s.w_B.sum() +
                                  s.a_B.sum() + s.airspeed_m_s + s.course_rad);
  if (good) {
    if (state_lost_) event(FlightEventType::kStateRegained);
    state_lost_ = false;
    state_good_s_ = in.t_s;
    return true;
  }
  if (in.t_s - state_good_s_ <= kStateGrace_s) return false;
  if (!state_lost_) event(FlightEventType::kStateLost);
  state_lost_ = true;
  out_.act = GuidanceAct::kGiveUp;
  return false;
}

double Guidance::measure_height(const Input& in) {
  const double tilt = cos_tilt(in.state.q_NB);
  range_seen_ = true;
  if (in.range_m && std::isfinite(*in.range_m) && *in.range_m >= 0.0 && tilt > kTooTilted &&
      *in.range_m <= config_.safety.longest_range_m) {
    return *in.range_m * tilt - standing_range_m_;
  }
  range_seen_ = false;
  const bool coming_down =
      out_.phase == Phase::kApproach || out_.phase == Phase::kFlare || out_.phase == Phase::kGlide;
  const double ground_m = coming_down ? landing_place_N().z() : start_N_.z();
  return ground_m - in.state.p_N.z();
}

bool Guidance::place_known(const Input& in) {
  const StateEstimate& s = in.state;
  if (s.horizontal == Trust::kGood && s.heading != Trust::kNone) place_good_s_ = in.t_s;
  const bool known = s.horizontal != Trust::kNone && s.heading != Trust::kNone &&
                     in.t_s - place_good_s_ <= config_.safety.dead_reckoning_s;
  if (!known && !place_lost_) event(FlightEventType::kPlaceLost);
  place_lost_ = !known;
  return known;
}

bool Guidance::motor_out(const Input& in, double dt_s) {
  const bool flying = out_.phase == Phase::kClimb || out_.phase == Phase::kMission ||
                      out_.phase == Phase::kLoiter || out_.phase == Phase::kReturn ||
                      out_.phase == Phase::kApproach;
  const StateEstimate& s = in.state;
  const double along_nose = s.a_B.x() - config_.controller.airframe.gravity_m_s2 *
                                            std::sin(RollPitch::of(s.q_NB).pitch_rad);
  const double energy_m_s =
      -s.v_N.z() + s.airspeed_m_s * along_nose / config_.controller.airframe.gravity_m_s2;
  const bool bad =
      flying && !pilot_ && in.last.throttle_full && energy_m_s < -config_.safety.motor_out_m_s;
  motor_bad_s_ = bad ? motor_bad_s_ + dt_s : 0.0;
  if (motor_bad_s_ > config_.safety.motor_out_s && !motor_lost_) {
    motor_lost_ = true;
    event(FlightEventType::kMotorOut);
  }
  return motor_lost_;
}

bool Guidance::on_ground(const Input& in, double dt_s) {
  const bool coming_down =
      out_.phase == Phase::kApproach || out_.phase == Phase::kFlare || out_.phase == Phase::kGlide;
  const bool rolls =
      std::abs(in.state.v_N.z()) < kTouch_m_s && out_.height_above_ground_m < kTouchHeight_m;
  // A sink that is asked for and does not come.
  ground_s_ = coming_down && rolls ? ground_s_ + dt_s : 0.0;
  const double needed_s = out_.phase == Phase::kFlare ? kTouch_s : 3.0 * kTouch_s;
  return ground_s_ > needed_s;
}

std::uint16_t Guidance::conditions(const Input& in, double dt_s, bool pilot) {
  const double height_m = start_N_.z() - in.state.p_N.z();
  const TakeoffConfig& takeoff = config_.takeoff;
  const double wanted_m = mission_.takeoff_height_m.value_or(takeoff.height_m);
  const bool moves = in.state.v_N.head<2>().norm() > kStill_m_s;
  still_s_ = moves ? 0.0 : still_s_ + dt_s;
  const double flare_m =
      std::max(flare_height_m_,
               config_.landing.flare_time_s * (in.state.v_N.z() - config_.landing.touchdown_m_s));
  const bool ends_down = mission_.at_end == AtEnd::kLand && out_.mission_done;
  const bool ends_home = mission_.at_end == AtEnd::kReturn && out_.mission_done;
  unsigned c = 0;
  const auto set = [&c](bool holds, unsigned which) { c |= holds ? which : 0U; };
  set(in.status.armed, Phases::kArmed);
  set(!flown_, Phases::kReady);
  set(pilot, Phases::kPilot);
  set(height_m > takeoff.airborne_m, Phases::kAirborne);
  set(height_m > wanted_m - takeoff.margin_m, Phases::kHighEnough);
  set(in.t_s - since_s_ > takeoff.timeout_s, Phases::kTooLate);
  set(path_done_, Phases::kPathDone);
  set(land_ || ends_down, Phases::kLandNext);
  set(return_ || ends_home, Phases::kReturnNext);
  set(place_known(in), Phases::kPlaceKnown);
  set(motor_out(in, dt_s), Phases::kMotorOut);
  set(out_.height_above_ground_m <= flare_m, Phases::kLow);
  set(on_ground(in, dt_s), Phases::kOnGround);
  set(still_s_ > kStill_s, Phases::kStands);
  return static_cast<std::uint16_t>(c);
}

double Guidance::choose_landing_course(const Input& in) const {
  if (mission_.landing.course_rad) return *mission_.landing.course_rad;
  const bool tail_wind = head_wind(in, start_course_rad_) < -kCalm_m_s;
  return tail_wind ? wrap_angle(start_course_rad_ + kPi) : start_course_rad_;
}

/// The aim point, as high as the centre of mass is when it stands there.
Vector3 Guidance::landing_place_N() const {
  return {mission_.landing.aim_N.x(), mission_.landing.aim_N.y(),
          start_N_.z() + mission_.landing.aim_N.z()};
}

double Guidance::head_wind(const Input& in, double course_rad) const {
  if (!in.state.wind_valid) return 0.0;
  return -in.state.wind_N.head<2>().dot(along(course_rad));
}

void Guidance::begin_path(const Input& in, std::vector<Waypoint> waypoints, bool cycle,
                          std::size_t first, double radius_m) {
  PlannerConfig plan = config_.plan;
  plan.radius_m = radius_m;
  double height_m = -in.state.p_N.z();
  const auto& wanted_m = in.last.wanted_height_m;
  if (wanted_m && std::abs(*wanted_m - height_m) < kNearReference_m) height_m = *wanted_m;
  const PathStart from{{in.state.p_N.head<2>(), in.state.course_rad}, height_m};
  path_ = PathManager(plan);
  path_.set_waypoints(waypoints, cycle);
  auto fault = path_.start(from, first);
  if (fault && waypoints[first].passing == Passing::kFillet && waypoints.size() > 1) {
    // From here its corner is too sharp to be rounded off: over it, already on the next leg.
    const Vector3& next_N = waypoints[(first + 1) % waypoints.size()].p_N;
    waypoints[first].passing = Passing::kDubins;
    waypoints[first].course_rad = course_of((next_N - waypoints[first].p_N).head<2>());
    path_.set_waypoints(std::move(waypoints), cycle);
    fault = path_.start(from, first);
  }
  if (fault) event(FlightEventType::kPathFault, fault->waypoint);
  path_done_ = !path_.started();
}

void Guidance::circle_here(const Input& in) {
  const double radius_m = mission_.radius_m.value_or(config_.plan.radius_m);
  here_ = {};
  here_.valid = true;
  here_.circle = true;
  here_.airspeed_m_s = config_.plan.airspeed_m_s;
  here_.radius_m = radius_m;
  here_.c_N << in.state.p_N.head<2>() + radius_m * right_of(in.state.course_rad),
      std::min(in.state.p_N.z(), start_N_.z() - config_.takeoff.airborne_m);
}

void Guidance::enter(Phase to, const Input& in) {
  const Phase from = out_.phase;
  out_.phase = to;
  since_s_ = in.t_s;
  event(FlightEventType::kPhase, static_cast<std::size_t>(to));
  const double radius_m = mission_.radius_m.value_or(config_.plan.radius_m);
  switch (to) {
    case Phase::kTakeoff:
      start_N_ = climb_from_N_ = in.state.p_N;
      standing_range_m_ = in.range_m.value_or(0.0);
      start_course_rad_ = heading_of(in.state.q_NB);
      out_.restart = true;
      break;
    case Phase::kMission:
      begin_path(in, mission_.waypoints, mission_.at_end == AtEnd::kCycle, out_.waypoint, radius_m);
      break;
    case Phase::kReturn: {
      Waypoint home;
      home.p_N = start_N_ - Vector3(0.0, 0.0, config_.safety.return_height_m);
      home.passing = Passing::kCircle;
      home.hold_indefinitely = true;
      begin_path(in, {home}, false, 0, radius_m);
      break;
    }
    case Phase::kApproach: {
      landing_course_rad_ = choose_landing_course(in);
      const LandingPath landing =
          LandingPath::plan(config_.landing, landing_place_N(), landing_course_rad_,
                            config_.plan.airspeed_m_s, head_wind(in, landing_course_rad_));
      flare_height_m_ = landing.flare_height_m;
      begin_path(in, {landing.waypoints.begin(), landing.waypoints.end()}, false, 0,
                 config_.plan.radius_m);
      break;
    }
    case Phase::kLoiter:
      circle_here(in);
      break;
    case Phase::kGlide:
      here_ = {};
      here_.valid = here_.circle = true;
      here_.airspeed_m_s = config_.safety.glide_m_s;
      here_.radius_m = config_.plan.radius_m;
      here_.c_N = landing_place_N();
      break;
    case Phase::kFlare:
      flare_throttle_ = motor_lost_ ? 0.0 : in.last.throttle;
      break;
    case Phase::kRollout:
      roll_course_rad_ = heading_of(in.state.q_NB);
      if (from == Phase::kTakeoff) event(FlightEventType::kTakeoffFailed);
      break;
    case Phase::kLanded:
      flown_ = true;
      break;
    case Phase::kClimb:
      climb_from_N_ = in.state.p_N;
      break;
    case Phase::kDisarmed:
      break;
  }
}

/// The line of the take-off; from where it is airborne it climbs.
CurrentPath Guidance::straight_on() const {
  CurrentPath out;
  out.valid = true;
  out.airspeed_m_s = config_.plan.airspeed_m_s;
  out.r_N = start_N_;
  out.r_N.z() = climb_from_N_.z();
  out.q_N << along(start_course_rad_), 0.0;
  if (out_.phase == Phase::kClimb) {
    const Vector2 flown = (climb_from_N_ - start_N_).head<2>();
    out.r_N.head<2>() += flown.dot(along(start_course_rad_)) * along(start_course_rad_);
    out.q_N.z() = -config_.plan.climb_slope;
    out.q_N.normalize();
  }
  return out;
}

void Guidance::follow_path(const Input& in) {
  const double lead_m = config_.lead_s * in.state.v_N.head<2>().norm();
  out_.path = path_.step(in.state.p_N, lead_m);
  if (out_.phase != Phase::kMission) return;
  if (out_.path.passed) {
    event(FlightEventType::kWaypointPassed, *out_.path.passed, out_.path.passed_at_m);
  }
  if (path_.started()) out_.waypoint = out_.path.waypoint;
  if (out_.path.done && !out_.mission_done) {
    out_.mission_done = path_done_ = true;
    event(FlightEventType::kMissionDone);
  }
}

Controller::Direct Guidance::direct(const Input& in) {
  Controller::Direct out;
  const double v = in.state.air_valid ? in.state.airspeed_m_s : in.state.v_N.head<2>().norm();
  switch (out_.phase) {
    case Phase::kTakeoff:
      return takeoff_direct(config_, v, in.t_s - since_s_, start_course_rad_);
    case Phase::kLoiter:
      if (place_lost_) out.roll_rad = config_.controller.lost_roll_rad;
      break;
    case Phase::kGlide:
      out.airspeed_by_pitch_m_s = config_.safety.glide_m_s;
      if (out_.height_above_ground_m < config_.safety.straight_below_m || place_lost_) {
        out.roll_rad = 0.0;
      }
      break;
    case Phase::kFlare:
      out.climb_m_s = flare_climb(config_.landing, out_.height_above_ground_m);
      out.throttle = std::max(flare_throttle_ - kFlareRamp_1_s * (in.t_s - since_s_),
                              motor_lost_ ? 0.0 : config_.landing.flare_throttle);
      out.max_roll_rad = config_.landing.max_roll_rad;
      out.max_pitch_rad = config_.landing.max_pitch_rad;
      out.min_pitch_rad = 0.0;
      if (motor_lost_) out.roll_rad = 0.0;
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

void Guidance::lead(const Input& in) {
  const bool planned = out_.phase == Phase::kMission || out_.phase == Phase::kReturn ||
                       out_.phase == Phase::kApproach || out_.phase == Phase::kFlare;
  if (planned) {
    follow_path(in);
    out_.follow = out_.path.path;
  } else if (out_.phase == Phase::kTakeoff || out_.phase == Phase::kClimb ||
             out_.phase == Phase::kRollout) {
    out_.follow = straight_on();
  } else {
    out_.follow = here_;
  }
  out_.direct = direct(in);
}

const GuidanceOutput& Guidance::step(const Input& in) {
  out_.event_count = 0;
  out_.act = GuidanceAct::kRepeat;
  out_.restart = false;
  if (!started_) {
    started_ = true;
    last_t_s_ = state_good_s_ = place_good_s_ = in.t_s;
    return out_;
  }
  out_.dt_s = in.t_s - last_t_s_;
  if (!(out_.dt_s > 0.0)) return out_;
  last_t_s_ = in.t_s;
  if (!state_good(in)) return out_;
  const bool pilot = PilotOverride::from_word(in.status.rc_override).any();
  out_.height_above_ground_m = measure_height(in);
  const Phase to = Phases::next(out_.phase, conditions(in, out_.dt_s, pilot));
  const bool idle_now = to == Phase::kDisarmed || to == Phase::kLanded;
  if (!idle_now && pilot != pilot_) {
    event(pilot ? FlightEventType::kPilotTookOver : FlightEventType::kPilotGaveBack);
  }
  pilot_ = !idle_now && pilot;
  const bool new_list = to == Phase::kMission && !path_.started();
  if (to != out_.phase || new_list) {
    enter(to, in);
  } else if (pilot_ && to == Phase::kLoiter) {
    circle_here(in);
  } else if (pilot_ && to == Phase::kTakeoff) {
    start_N_ = in.state.p_N;
    start_course_rad_ = heading_of(in.state.q_NB);
    since_s_ = in.t_s;
  }
  out_.request_disarm = out_.phase == Phase::kLanded;
  out_.landed = out_.landed || out_.phase == Phase::kLanded;
  if (out_.phase == Phase::kDisarmed || out_.phase == Phase::kLanded) {
    out_.act = GuidanceAct::kIdle;
    out_.follow = {};
    out_.direct = {};
    return out_;
  }
  out_.act = GuidanceAct::kFly;
  lead(in);
  return out_;
}

}  // namespace rosflight::autonomy::fixedwing
