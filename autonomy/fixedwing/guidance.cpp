// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/guidance.hpp"

#include <algorithm>
#include <stdexcept>

namespace rosflight::autonomy::fixedwing {

Guidance::Guidance(const FlightConfig& config, const Mission& mission) : config_(config) {
  set_mission(mission);
}

void Guidance::set_mission(const Mission& mission, std::size_t first) {
  if (mission.waypoints.empty()) throw std::invalid_argument("the mission has no waypoint");
  mission_ = mission;
  out_.waypoint = std::min(first, mission.waypoints.size() - 1);
  out_.mission_done = path_done_ = land_ = return_ = gap_returns_ = false;
  hold_until_s_ = 0.0;
  limits_.set_fence(mission_.fence);
  if (out_.phase == Phase::kLanded || out_.phase == Phase::kDisarmed) flown_ = false;
  // In flight the new list is planned from where the vehicle is.
  if (out_.phase == Phase::kMission) phase_path_.stop();
}

void Guidance::revise_mission(const Mission& mission, std::size_t next) {
  if (mission.waypoints.empty()) throw std::invalid_argument("the mission has no waypoint");
  next = std::min(next, mission.waypoints.size() - 1);
  if (next != out_.waypoint || mission.at_end != mission_.at_end) out_.mission_done = false;
  path_done_ = path_done_ && out_.mission_done;
  const std::optional<Fence> fence = mission_.fence;
  mission_ = mission;
  mission_.fence = fence;
  out_.waypoint = next;
  if (out_.phase == Phase::kMission) phase_path_.stop();
}

void Guidance::set_fence(const std::optional<Fence>& fence) {
  mission_.fence = fence;
  limits_.set_fence(fence);
}

bool Guidance::descending() const {
  return out_.phase == Phase::kApproach || out_.phase == Phase::kFlare ||
         out_.phase == Phase::kGlide || out_.phase == Phase::kDescent;
}

double Guidance::height_above_ground_m(const Input& in) {
  const Vector3 ground_W =
      descending() ? phase_path_.landing_position_W(mission_) : phase_path_.start_W();
  return ground_.height_m(in.state, in.range_m, config_.safety.max_range_m, -ground_W.z());
}

PhaseConditions Guidance::conditions(const Input& in, bool pilot) {
  const double height_m = phase_path_.start_W().z() - in.state.p_W.z();
  const TakeoffConfig& takeoff = config_.takeoff;
  const double wanted_m = mission_.takeoff_height_m.value_or(takeoff.height_m);
  const double flare_m = phase_path_.flare_height_m(config_.landing, in.state.v_W.z());
  const bool motor_runs = out_.phase == Phase::kClimb || out_.phase == Phase::kMission ||
                          out_.phase == Phase::kLoiter || out_.phase == Phase::kReturn ||
                          out_.phase == Phase::kApproach || out_.phase == Phase::kDescent;
  // While the flight controller flies its failsafe command the throttle is not ours.
  const bool full_throttle = motor_runs && !pilot_ && !in.status.failsafe && in.last.throttle_full;
  const bool ends_down = mission_.at_end == AtEnd::kLand && out_.mission_done;
  const bool ends_home = mission_.at_end == AtEnd::kReturn && out_.mission_done;
  PhaseConditions out;
  out.set(Conditions::kArmed, in.status.armed);
  out.set(Conditions::kPilot, pilot);
  out.set(Conditions::kAirborne, height_m > takeoff.airborne_m && !in.state.bridging);
  out.set(Conditions::kHighEnough, height_m > wanted_m - takeoff.margin_m);
  // How far it has rolled meanwhile, and whether it has touched down again, is not known.
  constexpr double kGround_m = 0.5;
  broken_off_ = blind_s_ > takeoff.interrupted_s && !in.state.bridging &&
                out_.height_above_ground_m < kGround_m;
  out.set(Conditions::kTooLate, phase_path_.since_s(in.t_s) > takeoff.timeout_s || broken_off_);
  out.set(Conditions::kPathDone, path_done_);
  out.set(Conditions::kLandNext, land_ || ends_down || limits_.asks_land());
  out.set(Conditions::kReturnNext, return_ || ends_home || limits_.asks_return() || gap_returns_);
  out.set(Conditions::kHolds, in.t_s < hold_until_s_);
  const bool known = faults_.position_known(in.state, in.t_s, config_.safety, out_.events);
  // Just above the ground a landing goes on: there is no room to circle.
  const bool landing = out_.phase == Phase::kApproach &&
                       out_.height_above_ground_m < config_.safety.straight_below_m;
  out.set(Conditions::kPositionKnown, known || landing);
  out.set(Conditions::kComeDown, faults_.unaided_s(in.t_s) > config_.safety.position_wait_s ||
                                     limits_.asks_land() || in.state.vertical == Quality::kNone);
  out.set(Conditions::kMotorOut,
          faults_.motor_out(in.state, full_throttle, out_.dt_s, config_, out_.events));
  out.set(Conditions::kLow, out_.height_above_ground_m <= flare_m);
  out.set(Conditions::kOnGround, ground_.on_ground(in.state, out_.height_above_ground_m,
                                                   descending() || out_.phase == Phase::kLoiter,
                                                   out_.phase == Phase::kFlare, out_.dt_s));
  // Without a position the speed over ground is not known either.
  constexpr double kLongRollout_s = 20.0;
  const bool rolled_out = out_.phase == Phase::kRollout && faults_.position_lost() &&
                          phase_path_.since_s(in.t_s) > kLongRollout_s;
  const bool stands = ground_.stands(in.state, out_.dt_s) || rolled_out;
  const bool rolls_out = out_.phase == Phase::kRollout;
  if (rolls_out) retry_.step({in.state, stands, in.t_s - unhealthy_at_s_, out_.dt_s});
  out.set(Conditions::kStands, stands && !(rolls_out && retry_.waits()));
  out.set(Conditions::kReady, rolls_out ? retry_.due() : !flown_);
  return out;
}

PhasePath::Input Guidance::path_input(const Input& in) const {
  return {.t_s = in.t_s,
          .state = in.state,
          .config = config_,
          .mission = mission_,
          .last = in.last,
          .height_above_ground_m = out_.height_above_ground_m,
          .position_lost = faults_.position_lost(),
          .motor_lost = faults_.motor_lost()};
}

void Guidance::enter(Phase to, const Input& in) {
  const Phase from = out_.phase;
  out_.phase = to;
  out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(to));
  phase_path_.begin(to, out_.waypoint, path_input(in), out_.events);
  switch (to) {
    case Phase::kTakeoff:
      blind_s_ = 0.0;
      ground_.set_standing(in.range_m);
      out_.restart = true;
      if (from == Phase::kRollout) {
        out_.events.add(FlightEventType::kTakeoffAgain);
      } else {
        limits_.start(config_.battery, mission_.fence);
        retry_.start(in.state.p_W, heading_of(in.state.q_WB));
      }
      break;
    case Phase::kMission:
    case Phase::kReturn:
    case Phase::kApproach:
      path_done_ = !phase_path_.path().started();
      break;
    case Phase::kRollout:
      if (from == Phase::kTakeoff) {
        out_.events.add(FlightEventType::kTakeoffFailed);
        retry_.give_up(broken_off_ ? blind_s_ : 0.0);
      }
      break;
    case Phase::kLanded:
      flown_ = true;
      break;
    default:
      break;
  }
}

void Guidance::update_phase(const Input& in) {
  watch_limits(in);
  const bool failsafe = in.status.failsafe;
  const bool pilot = override_.step(in.status.rc_override, out_.dt_s).any() || failsafe;
  const Phase to = kPhaseTable.next(out_.phase, conditions(in, pilot || interrupted_).bits());
  const bool idle_now = to == Phase::kDisarmed || to == Phase::kLanded;
  if (!idle_now && pilot != pilot_) {
    const bool by_failsafe = failsafe || failsafe_;
    out_.events.add(
        pilot ? (by_failsafe ? FlightEventType::kFailsafeFlies : FlightEventType::kPilotTookOver)
              : (by_failsafe ? FlightEventType::kFailsafeOver : FlightEventType::kPilotGaveBack));
  }
  pilot_ = !idle_now && pilot;
  failsafe_ = failsafe;
  if (failsafe) blind_s_ += out_.dt_s;
  const bool new_list = to == Phase::kMission && !phase_path_.path().started();
  // Whether a take-off has left the ground meanwhile is known only once the gap is bridged.
  const bool unknown = to == Phase::kTakeoff && in.state.bridging;
  if (to != out_.phase || new_list) {
    enter(to, in);
  } else if ((pilot_ || interrupted_) && !unknown) {
    phase_path_.restart(to, path_input(in));
  }
  out_.request_disarm = out_.phase == Phase::kLanded;
  out_.landed = out_.landed || out_.phase == Phase::kLanded;
}

/// Battery and fence. Back at the start after a return that they or a long gap asked for, it lands.
void Guidance::watch_limits(const Input& in) {
  const bool flying = out_.phase != Phase::kDisarmed && out_.phase != Phase::kTakeoff &&
                      out_.phase != Phase::kRollout && out_.phase != Phase::kLanded;
  if (!flying) return;
  const Vector3 from_start_W = in.state.p_W - phase_path_.start_W();
  limits_.step(in.status, from_start_W, out_.dt_s, out_.events);
  constexpr double kThere = 2.5;  // turn radii: the circle above the start, and some
  const bool lands = (limits_.asks_return() || gap_returns_) && !return_;
  if (out_.phase == Phase::kReturn && lands &&
      from_start_W.head<2>().norm() < kThere * phase_path_.path().planner().config().radius_m) {
    land_ = true;
  }
}

void Guidance::lead(const Input& in) {
  const PhasePath::Output path = phase_path_.step(out_.phase, path_input(in));
  out_.follow = path.follow;
  out_.direct = path.direct;
  out_.on_path = path.planned;
  if (path.planned) out_.path = phase_path_.path().output();
  if (out_.phase != Phase::kMission) return;
  if (out_.path.passed) {
    out_.events.add(FlightEventType::kWaypointReached, *out_.path.passed, out_.path.passed_at_m);
  }
  if (phase_path_.path().started()) out_.waypoint = out_.path.waypoint;
  if (out_.path.done && !out_.mission_done) {
    out_.mission_done = path_done_ = true;
    out_.events.add(FlightEventType::kMissionDone);
  }
}

/// It stands, until it is disarmed.
void Guidance::rest() {
  if (out_.phase != Phase::kLanded) {
    out_.phase = Phase::kLanded;
    out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(Phase::kLanded));
  }
  rests_ = flown_ = out_.landed = out_.request_disarm = true;
  gliding_level_ = false;
  out_.act = GuidanceAct::kIdle;
}

/// After the grace: the pilot has the vehicle while the link is silent; with a link it glides down.
void Guidance::without_state(const Input& in) {
  out_.act = GuidanceAct::kGiveUp;
  if (!in.status.armed) {
    rests_ = rests_ || gliding_level_;
    return;
  }
  if (rests_) return rest();
  if (gap_.linked_s(in.t_s) < kStateGrace_s || out_.phase == Phase::kLanded) return;
  if (out_.phase == Phase::kDisarmed) {
    if (gap_.lasts_s(in.t_s) <= kTakeoffWait_s) return;
    out_.events.add(FlightEventType::kTakeoffFailed);
    return rest();
  }
  if (!gliding_level_) {
    gliding_level_ = true;
    before_glide_ = out_.phase;
    if (before_glide_ == Phase::kTakeoff) out_.events.add(FlightEventType::kTakeoffFailed);
    level_glide_.start(out_.height_above_ground_m, ground_.standing_range_m());
    out_.events.add(FlightEventType::kGlidesLevel);
    if (out_.phase != Phase::kGlide) {
      out_.phase = Phase::kGlide;
      out_.events.add(FlightEventType::kPhase, static_cast<std::size_t>(Phase::kGlide));
    }
  }
  if (level_glide_.step(in.raw, in.range_m, out_.dt_s)) return rest();
  out_.act = GuidanceAct::kGlideLevel;
  out_.follow = {};
  out_.direct = level_glide_.direct(config_.safety);
}

/// The vehicle can be guided again, after a time in which it could not be: GapWatch. A landing that was just
/// above the ground goes on.
void Guidance::end_gap(const Input& in) {
  interrupted_ = false;
  if (!in.status.armed) rests_ = false;
  if (gliding_level_) {
    gliding_level_ = false;
    const bool was_landing = before_glide_ == Phase::kApproach || before_glide_ == Phase::kFlare ||
                             before_glide_ == Phase::kRollout || before_glide_ == Phase::kTakeoff;
    const bool low = out_.height_above_ground_m < config_.safety.straight_below_m;
    enter(was_landing && low ? Phase::kFlare : Phase::kLoiter, in);
  }
  const double gap_s = gap_.step(in.t_s, true, in.status.silent_s);
  if (gap_s <= GapWatch::kGoesOn_s || !in.status.armed || rests_) return;
  const bool flies = out_.phase != Phase::kDisarmed && out_.phase != Phase::kRollout &&
                     out_.phase != Phase::kLanded;
  if (!flies) return;
  out_.events.add(FlightEventType::kLongGap);
  if (out_.phase == Phase::kTakeoff) blind_s_ = std::max(blind_s_, gap_s);
  interrupted_ = gap_returns_ = true;
  hold_until_s_ = in.t_s + GapWatch::kHold_s;
}

const GuidanceOutput& Guidance::step(const Input& in) {
  out_.events.count = 0;
  out_.act = GuidanceAct::kRepeat;
  out_.restart = false;
  if (!started_) {
    started_ = true;
    last_t_s_ = in.t_s;
    faults_.start(in.t_s);
    gap_.start(in.t_s);
    return out_;
  }
  out_.dt_s = in.t_s - last_t_s_;
  if (!(out_.dt_s > 0.0)) return out_;
  last_t_s_ = in.t_s;
  out_.on_path = false;
  const bool linked = GapWatch::linked(in.status.silent_s);
  if (in.status.failsafe) unhealthy_at_s_ = in.t_s;
  if (!faults_.state_good(in.state, in.t_s, out_.events, linked)) {
    blind_s_ += out_.dt_s;
    unhealthy_at_s_ = in.t_s;
    gap_.step(in.t_s, false, in.status.silent_s);
    if (faults_.state_lost()) without_state(in);
    return out_;
  }
  out_.height_above_ground_m = height_above_ground_m(in);
  end_gap(in);
  if (rests_) {
    rest();
    return out_;
  }
  update_phase(in);
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
