// SPDX-License-Identifier: BSD-3-Clause
#include "flight/guidance.hpp"

#include <fmt/format.h>

namespace rosflight::flight {
namespace {

using link::Severity;
namespace fixedwing = autonomy::fixedwing;

Guidance::Note say(Severity severity, std::string text) {
  return {severity, std::move(text)};
}

Guidance::Note arrival(std::size_t waypoint, bool reached, const char* how, double distance_m) {
  return say(
      reached ? Severity::kInfo : Severity::kWarning,
      fmt::format("waypoint {} {} at {:.2f} m by the estimate", waypoint + 1, how, distance_m));
}

Guidance::Note note_of(const autonomy::FlightEvent& e, const char* phase) {
  using Type = autonomy::FlightEventType;
  switch (e.type) {
    case Type::kPhase:
      return say(Severity::kInfo, fmt::format("phase {}", phase));
    case Type::kWaypointReached:
      return arrival(e.index, true, "reached", e.value);
    case Type::kWaypointMissed:
      return arrival(e.index, false, "missed", e.value);
    case Type::kMissionDone:
    case Type::kPilotGaveBack:
    case Type::kStateRegained:
    case Type::kFailsafeOver:
      return say(Severity::kInfo, name(e.type));
    case Type::kPilotTookOver:
    case Type::kThrustFault:
    case Type::kBatteryLow:
    case Type::kBatteryReturn:
    case Type::kFenceCrossed:
    case Type::kFailsafeFlies:
    case Type::kReturning:
    case Type::kAileronsLost:
    case Type::kSinksLevel:
    case Type::kGlidesLevel:
    case Type::kLongGap:
    case Type::kTakeoffAgain:
      return say(Severity::kWarning, name(e.type));
    case Type::kMotorOut:
      return say(Severity::kError, fmt::format("{}: motor {}", name(e.type), e.index));
    case Type::kTakeoffFailed:
    case Type::kPathFault:
    case Type::kPositionLost:
    case Type::kStateLost:
    case Type::kBatteryLand:
      break;
  }
  return say(Severity::kError, name(e.type));
}

/// The point of the path beside the vehicle, and how the path goes on there.
autonomy::multirotor::Trajectory beside(const fixedwing::FlightOutput& output) {
  const fixedwing::Segment& segment = output.path.segment;
  const double s_m = output.path.progress_m;
  const double course = segment.course_at(s_m);
  autonomy::multirotor::Trajectory out;
  out.p_W << segment.point_at(s_m), -output.path.height_m;
  out.v_W << output.wanted.airspeed_m_s * fixedwing::along(course), -output.wanted.climb_ff_m_s;
  out.psi_rad = autonomy::wrap_angle(course);
  return out;
}

template <typename Output>
void report(const Output& output, GuidanceOutput& out, const Guidance::Notify& notify) {
  for (const auto& event : output.events) notify(note_of(event, name(output.phase)));
  out.command = output.command;
  out.phase = name(output.phase);
  out.tracking = output.tracking;
  out.waypoint = output.waypoint;
  out.mission_done = output.mission_done;
  out.landed = output.landed;
  out.request_disarm = output.request_disarm;
}

}  // namespace

const GuidanceOutput& MultirotorGuidance::step(const Input& in, const Notify& notify) {
  autonomy::multirotor::State state;
  state.p_W = in.state.p_W;
  state.v_W = in.state.v_W;
  state.q_WB = in.state.q_WB;
  state.w_B = in.state.w_B;
  state.horizontal = in.state.horizontal != autonomy::Quality::kNone;
  constexpr double kFollowed_s = 3.0;  // by dead reckoning alone
  state.aided =
      in.state.horizontal == autonomy::Quality::kGood || in.state.dead_reckoning_s < kFollowed_s;
  state.vertical = in.state.vertical != autonomy::Quality::kNone;
  const autonomy::multirotor::FlightOutput& output =
      manager_.step({in.t_s, state, in.status, in.range_m, in.outputs, in.raw});
  report(output, out_, notify);
  using autonomy::multirotor::Phase;
  out_.idle = output.phase == Phase::kDisarmed || output.phase == Phase::kLanded;
  out_.in_air = output.phase == Phase::kPositionHold || output.phase == Phase::kOffboard;
  out_.coming_down = output.phase == Phase::kLanding;
  out_.setpoint = output.setpoint;
  out_.distance_m = output.distance_m;
  return out_;
}

const GuidanceOutput& FixedWingGuidance::step(const Input& in, const Notify& notify) {
  const fixedwing::FlightOutput& output = manager_.step({.t_s = in.t_s,
                                                         .state = in.state,
                                                         .status = in.status,
                                                         .range_m = in.range_m,
                                                         .raw = in.raw});
  report(output, out_, notify);
  using fixedwing::Phase;
  const Phase phase = output.phase;
  out_.idle = phase == Phase::kDisarmed || phase == Phase::kLanded;
  out_.in_air = phase == Phase::kClimb || phase == Phase::kMission || phase == Phase::kLoiter ||
                phase == Phase::kReturn;
  out_.coming_down = phase == Phase::kApproach || phase == Phase::kDescent ||
                     phase == Phase::kGlide || phase == Phase::kFlare || phase == Phase::kRollout;
  out_.on_path = output.on_path && output.path.path.valid;
  if (out_.on_path) out_.setpoint = beside(output);
  out_.distance_m = output.path.passed_at_m;
  return out_;
}

const GuidanceOutput& QuadplaneGuidance::step(const Input& in, const Notify& notify) {
  const autonomy::quadplane::FlightOutput& output =
      manager_.step({in.t_s, in.state, in.status, in.range_m});
  report(output, out_, notify);
  using autonomy::quadplane::Phase;
  const Phase phase = output.phase;
  out_.idle = phase == Phase::kDisarmed || phase == Phase::kLanded;
  out_.in_air = phase == Phase::kTransition || phase == Phase::kCruise || phase == Phase::kBack ||
                phase == Phase::kHover;
  out_.coming_down = phase == Phase::kLanding;
  out_.setpoint = output.setpoint;
  out_.on_path = output.tracking;
  out_.distance_m = output.distance_m;
  return out_;
}

}  // namespace rosflight::flight
