// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/learner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/flight_manager.hpp"
#include "base/constants.hpp"
#include "companion/offboard.hpp"
#include "firmware/core/firmware.hpp"
#include "flight/true_state.hpp"

namespace rosflight::python {
namespace {

namespace fixedwing = autonomy::fixedwing;

constexpr double kStep_s = 1e-6 * static_cast<double>(flight::Simulation::kStep.count());
constexpr int kCommandSteps = 4;  ///< Commands are sent 100 times per second while an action lasts.

sim::RandomStream episodes(std::uint64_t seed) {
  return sim::RandomSource{seed}.stream("python/episodes");
}

template <class Vector>
float* put(const Vector& v, float* to) {
  for (int k = 0; k < 3; ++k) *to++ = static_cast<float>(v[k]);
  return to;
}

/// A fixed wing that takes off flies where a mission may. @throws config::Error
void check_altitude(const flight::FlightSetup& setup, double altitude_m) {
  const autonomy::MissionArea& area =
      std::get<flight::FixedWingPlan>(setup.plan).autonomy.mission.area;
  if (altitude_m >= area.min_height_m && altitude_m <= area.max_height_m) return;
  throw config::Error(fmt::format("altitude_m: found {} for {} with a link, allowed {} to {}",
                                  altitude_m, setup.choice.vehicle, area.min_height_m,
                                  area.max_height_m));
}

link::ExternalAttitude attitude_of(const sim::Quaternion& q) {
  link::ExternalAttitude attitude;
  attitude.q_WB = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                   static_cast<float>(q.z())};
  return attitude;
}

}  // namespace

Learner::Learner(flight::FlightSetup& setup, const TaskConfig& task,
                 const flight::FlightSetup& known, const Connection& connection, std::uint64_t seed)
    : config_{task},
      connection_{connection},
      seed_{seed},
      simulation_{(setup.choice.seed = seed, setup)},
      task_{Task::make(task, setup, simulation_.truth().body.p_W)},
      map_{known, connection.action},
      random_{episodes(seed)} {
  if (connection.link && setup.fixed_wing()) check_altitude(setup, task.altitude_m);
}

void Learner::start() {
  simulation_.start();
  map_.read_mixer(simulation_.firmware());
  if (!connection_.link) {
    turn_rotors();
  } else if (simulation_.setup().fixed_wing()) {
    take_off_and_circle();
  } else {
    take_off();
  }
  ready_ = simulation_.save();
}

void Learner::turn_rotors() {
  simulation_.drop_link();
  // Held on the ground, so that the firmware has no error to integrate.
  simulation_.set_held(true);
  constexpr int kCommands = 100;
  const auto throttle = static_cast<float>(simulation_.setup().hover_throttle);
  const bool fixed_wing = simulation_.setup().fixed_wing();
  for (int k = 0; k < kCommands; ++k) {
    simulation_.tell(fixed_wing ? companion::surfaces(0.0F, 0.0F, 0.0F, throttle)
                                : companion::body_rates(0.0F, 0.0F, 0.0F, throttle));
    simulation_.step();
  }
  simulation_.set_held(false);
  const std::span<const double> turning = simulation_.module_state();
  hovering_.assign(turning.begin(), turning.end());
}

void Learner::take_off() {
  constexpr double kSettled_m = 0.1;
  fly_to({0.0, 0.0, -config_.altitude_m}, 0.0, kSettled_m);
  while (!simulation_.session().idle()) simulation_.step();
}

/// As in a mission, by the companion on its estimate, until it circles above where it stood.
void Learner::take_off_and_circle() {
  constexpr double kOnCircle_m = 10.0;
  constexpr double kAtAltitude_m = 2.0;
  constexpr double kTooLong_s = 240.0;
  const auto& config = std::get<flight::FixedWingPlan>(simulation_.setup().plan).autonomy.flight;
  fixedwing::Waypoint above;
  above.p_W = {0.0, 0.0, -config_.altitude_m};
  above.passing = fixedwing::Passing::kCircle;
  above.hold_indefinitely = true;
  fixedwing::Mission mission;
  mission.waypoints = {above};
  mission.takeoff_height_m = std::min(config.takeoff.height_m, config_.altitude_m);
  fixedwing::FlightManager pilot{config, mission};
  autonomy::Status status;
  status.armed = true;
  simulation_.set_held(false);  // the world holds a fixed wing until it takes off
  fly_by_companion(kTooLong_s, [&](const autonomy::StateEstimate& state) {
    const double now_s = sim::to_seconds(simulation_.now());
    const fixedwing::FlightOutput& out =
        pilot.step({.t_s = now_s, .state = state, .status = status, .range_m = {}});
    const bool circles = out.phase == fixedwing::Phase::kMission && !out.path.segment.straight() &&
                         std::isinf(out.path.segment.length_m) &&
                         std::abs(out.path.cross_track_m) < kOnCircle_m &&
                         std::abs(state.p_W.z() + config_.altitude_m) < kAtAltitude_m;
    return circles ? std::nullopt : std::optional{out.command};
  });
  while (!simulation_.session().idle()) simulation_.step();
}

/// By the controller of the companion on its estimate, until it is there and slow.
void Learner::fly_to(const sim::Vector3& p_W, double heading_rad, double near_m) {
  constexpr double kSlow_m_s = 0.3;
  constexpr double kTooLong_s = 60.0;
  MultirotorLoops pilot{std::get<flight::MultirotorPlan>(simulation_.setup().plan).autonomy};
  pilot.fly_to(p_W, heading_rad);
  fly_by_companion(kTooLong_s, [&](const autonomy::StateEstimate& state) {
    const bool there = (p_W - state.p_W).norm() < near_m && state.v_W.norm() < kSlow_m_s;
    return there ? std::nullopt
                 : std::optional{
                       pilot.step(state, kCommandSteps * kStep_s, truth().battery_voltage_V)};
  });
}

/// A fixed wing, likewise, until its course and its altitude are these.
void Learner::fly_along(double course_rad, double height_m) {
  constexpr double kAlong_rad = 3.0 * base::kRadPerDeg;
  constexpr double kLevel_rad = 10.0 * base::kRadPerDeg;
  constexpr double kSteady_rad_s = 0.2;
  constexpr double kNear_m = 1.0;
  constexpr double kLevel_m_s = 0.5;
  constexpr double kTooLong_s = 120.0;
  FixedWingLoops pilot{std::get<flight::FixedWingPlan>(simulation_.setup().plan).autonomy};
  pilot.fly_course(course_rad, height_m);
  fly_by_companion(kTooLong_s, [&](const autonomy::StateEstimate& state) {
    const bool along = std::abs(autonomy::wrap_angle(state.course_rad - course_rad)) < kAlong_rad &&
                       std::abs(autonomy::RollPitch::of(state.q_WB).roll_rad) < kLevel_rad &&
                       state.w_B.norm() < kSteady_rad_s;
    const bool level =
        std::abs(state.p_W.z() + height_m) < kNear_m && std::abs(state.v_W.z()) < kLevel_m_s;
    return along && level ? std::nullopt
                          : std::optional{pilot.step(state, kCommandSteps * kStep_s,
                                                     truth().battery_voltage_V)};
  });
}

/// @param step  gives the command of each period; none: it is where it should be.
void Learner::fly_by_companion(
    double too_long_s,
    const std::function<std::optional<autonomy::FirmwareCommand>(const autonomy::StateEstimate&)>&
        step) {
  for (int k = 0; k * kStep_s < too_long_s; ++k) {
    if (k % kCommandSteps == 0) {
      const auto command = step(simulation_.estimate());
      if (!command) return;
      send(sent(*command));
    }
    simulation_.step();
  }
  throw flight::Simulation::Error("start: the vehicle does not reach the start of an episode");
}

void Learner::rewind() {
  simulation_.restore(*ready_);
  random_ = episodes(seed_);
  begin_episode();
}

void Learner::begin_episode() {
  underway_.clear();
  action_ = {};
  steps_ = 0;
  map_.restart();
  const Task::Start start = task_->begin(random_);
  if (connection_.link) {
    simulation_.restore(*ready_);
    const sim::Vector3 nose_W = start.body.q_WB * sim::Vector3::UnitX();
    const double heading_rad = std::atan2(nose_W.y(), nose_W.x());
    constexpr double kNear_m = 0.3;
    if (simulation_.setup().fixed_wing()) {
      fly_along(heading_rad, -start.body.p_W.z());
    } else {
      fly_to(start.body.p_W, heading_rad, kNear_m);
    }
    task_->place(truth().body);
    return;
  }
  simulation_.restore_firmware(*ready_);
  const bool own = !start.module_state.empty();
  if (!simulation_.set_state(start.body, own ? start.module_state : hovering_))
    throw config::Error("reset: found a start below the ground, allowed above it");
}

SeenState Learner::seen() const {
  return connection_.observation == "truth" ? SeenState::of(truth())
                                            : SeenState::of(simulation_.estimate());
}

/// What the loops of the companion get.
autonomy::StateEstimate Learner::flown_on() const {
  if (!map_.depends_on_state()) return {};
  return connection_.observation == "truth" ? flight::true_state(truth()) : simulation_.estimate();
}

link::OffboardControl Learner::command() {
  const autonomy::StateEstimate state = flown_on();
  return map_.command(state, kCommandSteps * kStep_s, truth().battery_voltage_V);
}

void Learner::send(const link::OffboardControl& command) {
  if (connection_.link) {
    // One that the transport does not take is lost, as on a serial port.
    static_cast<void>(simulation_.session().offboard().send(command));
    if (simulation_.setup().fixed_wing()) share_attitude();
  } else {
    simulation_.tell(command);
  }
}

/// As in a mission: the firmware's own filter takes the direction of the load for that of gravity. Without a link the truth
/// stands for the estimate.
void Learner::share_attitude() {
  if (!connection_.link) {
    simulation_.tell(attitude_of(truth().body.q_WB));
    return;
  }
  const autonomy::StateEstimate state = simulation_.estimate();
  if (!simulation_.setup().estimator.share_attitude || state.attitude != autonomy::Quality::kGood)
    return;
  static_cast<void>(simulation_.session().offboard().send(attitude_of(state.q_WB)));
}

void Learner::step_once() {
  while (!underway_.empty() && underway_.front().at_step <= steps_) {
    send(underway_.front().command);
    underway_.pop_front();
  }
  simulation_.step();
  task_->advance(truth());
  ++steps_;
}

Learner::Result Learner::step(const Action& action) {
  action_ = action;
  map_.begin(task_->flown(action), flown_on());
  for (int k = 0; k < connection_.substeps; ++k) {
    if (k % kCommandSteps == 0) {
      if (task_->angles() != nullptr) share_attitude();
      if (connection_.delay_steps == 0) {
        send(command());
      } else {
        underway_.push_back({steps_ + connection_.delay_steps, command()});
      }
    }
    step_once();
  }

  const Task::Verdict verdict = task_->judge(truth(), connection_.substeps * kStep_s);
  const bool lost = verdict.lost || !simulation_.firmware().state().armed();
  constexpr double kCrash = 2.0;
  Result result;
  result.reward = static_cast<float>(verdict.reward - (lost ? kCrash : 0.0));
  result.terminated = lost || verdict.done;
  result.truncated = !result.terminated && steps_ * kStep_s >= config_.episode_s;
  result.success = !lost && verdict.success && (result.terminated || result.truncated);
  return result;
}

/// Its own estimate of now, and the action that it flies by.
void Learner::observe_firmware(const core::CommandVector& angles, float* to) const {
  constexpr std::size_t kThrottleAxis = 2;  // a policy of rates does not get it
  core::Policy::Outputs last{};
  for (std::size_t k = 0; k < last.size(); ++k) last[k] = std::clamp(action_[k], -1.0F, 1.0F);
  const core::AttitudeEstimate& state = simulation_.firmware().estimator().estimate();
  const auto all = core::LearnedController::inputs(angles, state, last, kThrottleAxis);
  std::copy_n(all.begin(), core::Policy::kRateInputs, to);
}

void Learner::observe(float* out) {
  if (const core::CommandVector* angles = task_->angles()) return observe_firmware(*angles, out);
  const SeenState state = seen();
  out = put(to_target(state.p_W), out);
  out = put(state.v_W, out);
  const sim::Matrix3 R_WB = state.q_WB.toRotationMatrix();
  for (int row = 0; row < 3; ++row) out = put(R_WB.row(row), out);
  out = put(state.w_B, out);
  out = std::ranges::copy(action_, out).out;
  out = task_->observe(state, out);
  if (connection_.observation == "sensors") observe_sensors(out);
}

/// What arrived last over the link.
float* Learner::observe_sensors(float* to) {
  constexpr float kMicrotesla = 1e6F;
  const companion::Streams& streams = simulation_.session().streams();
  to = std::ranges::copy(streams.imu.value.gyro_rad_s, to).out;
  to = std::ranges::copy(streams.imu.value.accel_m_s2, to).out;
  for (const float field_T : streams.mag.value.field_T) *to++ = kMicrotesla * field_T;
  *to++ = streams.baro.value.altitude_m;
  *to++ = streams.range.value.range_m;
  *to++ = streams.diff_pressure.value.airspeed_m_s;
  return std::ranges::copy(streams.gnss.value.velocity_ned_m_s, to).out;
}

}  // namespace rosflight::python
