// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/flight_manager.hpp"

namespace rosflight::autonomy::fixedwing {

FirmwareCommand command_of(const Surfaces& s) {
  FirmwareCommand out;
  out.u[0] = static_cast<float>(s.throttle);
  out.u[3] = static_cast<float>(s.aileron);
  out.u[4] = static_cast<float>(s.elevator);
  out.u[5] = static_cast<float>(s.rudder);
  return out;
}

FlightManager::FlightManager(const FlightConfig& config, const Mission& mission)
    : guidance_(config, mission), follower_(config.follower), controller_(config.controller) {}

void FlightManager::set_mission(const Mission& mission) {
  guidance_.set_mission(mission);
  static_cast<GuidanceOutput&>(out_) = guidance_.output();
}

void FlightManager::configure(const FlightConfig& config) {
  guidance_.configure(config);
  controller_.configure(config.controller);
  follower_ = PathFollower(config.follower);
}

/// Without the flight controller's attitude it has the surfaces, and the throttle is closed.
void FlightManager::glide_level(const RawMotion& raw) {
  constexpr std::uint16_t kAllButThrottle = kIgnoreAll - 1U;
  out_.wanted = {};
  out_.tracking = false;
  out_.command = FirmwareCommand{};
  out_.command.ignore = kAllButThrottle;
  if (!raw.q_WB) return;
  const StateEstimate state = LevelGlide::state(raw);
  out_.control = controller_.step({state, out_.wanted, 0.0, out_.dt_s, {}, out_.direct});
  out_.command = command_of(out_.control.surfaces);
}

const FlightOutput& FlightManager::step(const Input& in) {
  const Guidance::Last last{out_.control.throttle_full, out_.control.surfaces.throttle,
                            out_.wanted.valid ? std::optional(out_.wanted.height_m) : std::nullopt};
  static_cast<GuidanceOutput&>(out_) =
      guidance_.step({in.t_s, in.state, in.status, in.range_m, last, in.raw});
  if (out_.restart) controller_.reset();
  switch (out_.act) {
    case GuidanceAct::kRepeat:
      break;
    case GuidanceAct::kGiveUp:
      out_.command.ignore = kIgnoreAll;
      break;
    case GuidanceAct::kGlideLevel:
      glide_level(in.raw);
      break;
    case GuidanceAct::kIdle:
      out_.command = FirmwareCommand{};
      out_.control = {};
      out_.wanted = {};
      out_.tracking = false;
      break;
    case GuidanceAct::kFly: {
      const PilotOverride pilot = in.status.failsafe
                                      ? PilotOverride{true, true, true}
                                      : PilotOverride::from_word(in.status.rc_override);
      out_.wanted = follower_.step(in.state, out_.follow, 0.0);
      const bool had_ailerons = !out_.control.aileron_lost;
      out_.control = controller_.step({in.state, out_.wanted, 0.0, out_.dt_s, pilot, out_.direct});
      if (had_ailerons && out_.control.aileron_lost) {
        out_.events.add(FlightEventType::kAileronsLost);
      }
      out_.command = command_of(out_.control.surfaces);
      out_.tracking = out_.phase == Phase::kMission && out_.follow.valid && !pilot.any();
      break;
    }
  }
  return out_;
}

}  // namespace rosflight::autonomy::fixedwing
