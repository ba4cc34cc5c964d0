// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/guide.hpp"

#include <fmt/format.h>

namespace rosflight::apps {
namespace {

using link::Severity;
namespace wing = autonomy::fixedwing;

Guide::Note say(Severity severity, std::string text) {
  Guide::Note note;
  note.severity = severity;
  note.text = std::move(text);
  return note;
}

Guide::Note arrival(std::size_t waypoint, bool reached, const char* how, double distance_m) {
  Guide::Note note = say(reached ? Severity::kInfo : Severity::kWarning,
                         fmt::format("waypoint {} {} at {:.2f} m", waypoint + 1, how, distance_m));
  note.waypoint = waypoint;
  note.reached = reached;
  note.distance_m = distance_m;
  return note;
}

Guide::Note note_of(const autonomy::FlightEvent& e, autonomy::Phase phase) {
  using Type = autonomy::FlightEventType;
  switch (e.type) {
    case Type::kPhase:
      return say(Severity::kInfo, fmt::format("phase {}", name(phase)));
    case Type::kWaypointReached:
      return arrival(e.index, true, "reached", e.value);
    case Type::kWaypointMissed:
      return arrival(e.index, false, "missed", e.value);
    case Type::kMissionDone:
      return say(Severity::kInfo, "mission done");
    case Type::kTakeoffFailed:
      return say(Severity::kError, "take-off failed");
    case Type::kPilotTookOver:
      return say(Severity::kWarning, "pilot took over");
    case Type::kPilotGaveBack:
      return say(Severity::kInfo, "pilot gave back");
    case Type::kStateLost:
      return say(Severity::kError, "state lost");
    case Type::kStateRegained:
      return say(Severity::kInfo, "state regained");
  }
  return {};
}

Guide::Note note_of(const wing::FlightEvent& e) {
  using Type = wing::FlightEventType;
  switch (e.type) {
    case Type::kPhase:
      return say(Severity::kInfo, fmt::format("phase {}", name(static_cast<wing::Phase>(e.index))));
    case Type::kWaypointPassed:
      return arrival(e.index, true, "passed", e.value);
    case Type::kMissionDone:
    case Type::kPilotGaveBack:
    case Type::kStateRegained:
      return say(Severity::kInfo, name(e.type));
    case Type::kPilotTookOver:
      return say(Severity::kWarning, name(e.type));
    default:
      return say(Severity::kError, name(e.type));
  }
}

/// The point of the path beside the vehicle, and how the path goes on there.
autonomy::Trajectory beside(const wing::FlightOutput& output) {
  const wing::Segment& segment = output.path.segment;
  const double s_m = output.path.progress_m;
  const double course = segment.course_at(s_m);
  autonomy::Trajectory out;
  out.p_N << segment.point_at(s_m), -output.path.height_m;
  out.v_N << output.wanted.airspeed_m_s * wing::along(course), -output.wanted.climb_ff_m_s;
  out.psi_rad = autonomy::wrap_angle(course);
  return out;
}

}  // namespace

const GuideOutput& MultirotorGuide::step(const Input& in, const Notify& notify) {
  autonomy::State state;
  state.p_N = in.state.p_N;
  state.v_N = in.state.v_N;
  state.q_NB = in.state.q_NB;
  state.w_B = in.state.w_B;
  const autonomy::FlightOutput& output = manager_.step(in.t_s, state, in.status);
  for (std::size_t k = 0; k < output.events.count; ++k) {
    notify(note_of(output.events.list[k], output.phase));
  }
  using autonomy::Phase;
  out_.command = output.command;
  out_.phase = name(output.phase);
  out_.idle = output.phase == Phase::kDisarmed || output.phase == Phase::kLanded;
  out_.in_air = output.phase == Phase::kPositionHold || output.phase == Phase::kOffboard;
  out_.coming_down = output.phase == Phase::kLanding;
  out_.tracking = output.tracking;
  out_.setpoint = output.setpoint;
  out_.waypoint = output.waypoint;
  out_.distance_m = output.distance_m;
  out_.mission_done = output.mission_done;
  out_.landed = output.landed;
  out_.request_disarm = output.request_disarm;
  return out_;
}

const GuideOutput& FixedWingGuide::step(const Input& in, const Notify& notify) {
  const wing::FlightOutput& output =
      manager_.step({.t_s = in.t_s, .state = in.state, .status = in.status, .range_m = in.range_m});
  for (std::size_t k = 0; k < output.event_count; ++k) notify(note_of(output.events[k]));
  using wing::Phase;
  const Phase phase = output.phase;
  out_.command = output.command;
  out_.phase = name(phase);
  out_.idle = phase == Phase::kDisarmed || phase == Phase::kLanded;
  out_.in_air = phase == Phase::kClimb || phase == Phase::kMission || phase == Phase::kLoiter ||
                phase == Phase::kReturn;
  out_.coming_down = phase == Phase::kApproach || phase == Phase::kGlide ||
                     phase == Phase::kFlare || phase == Phase::kRollout;
  out_.tracking = output.tracking;
  if (output.path.path.valid) out_.setpoint = beside(output);
  out_.waypoint = output.waypoint;
  out_.distance_m = output.path.passed_at_m;
  out_.mission_done = output.mission_done;
  out_.landed = output.landed;
  out_.request_disarm = output.request_disarm;
  return out_;
}

}  // namespace rosflight::apps
