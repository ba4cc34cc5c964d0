// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/learner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "companion/offboard.hpp"
#include "firmware/core/firmware.hpp"

namespace rosflight::python {
namespace {

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

}  // namespace

Learner::Learner(flight::FlightSetup& setup, const TaskConfig& task, const ActionMap& map,
                 const Connection& connection, std::uint64_t seed)
    : config_{task},
      connection_{connection},
      map_{map},
      seed_{seed},
      simulation_{(setup.choice.seed = seed, setup)},
      task_{Task::make(task, setup, simulation_.truth().body.p_W)},
      random_{episodes(seed)} {
  if (connection.link && setup.fixed_wing()) {
    throw config::Error(
        fmt::format("link: found true for {}, a fixed wing, allowed false", setup.choice.vehicle));
  }
}

void Learner::start() {
  simulation_.start();
  map_.read_mixer(simulation_.firmware());
  if (connection_.link) {
    take_off();
  } else {
    turn_rotors();
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

/// By the controller of the companion on its estimate, until it is there and slow.
void Learner::fly_to(const sim::Vector3& p_W, double heading_rad, double near_m) {
  constexpr double kSlow_m_s = 0.3;
  constexpr double kTooLong_s = 60.0;
  ActionMap pilot{simulation_.setup(), "waypoint"};
  pilot.restart();
  for (int k = 0; k * kStep_s < kTooLong_s; ++k) {
    if (k % kCommandSteps == 0) {
      const SeenState state = SeenState::of(simulation_.estimate());
      const double distance_m = (p_W - state.p_W).norm();
      if (distance_m < near_m && state.v_W.norm() < kSlow_m_s) return;
      pilot.fly_to(p_W, heading_rad);
      send(pilot.command(state, kCommandSteps * kStep_s, truth().battery_voltage_V));
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
    constexpr double kNear_m = 0.3;
    fly_to(start.body.p_W, std::atan2(nose_W.y(), nose_W.x()), kNear_m);
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

link::OffboardControl Learner::command() {
  const SeenState state = map_.depends_on_state() ? seen() : SeenState{};
  return map_.command(state, kCommandSteps * kStep_s, truth().battery_voltage_V);
}

void Learner::send(const link::OffboardControl& command) {
  if (connection_.link) {
    // One that the transport does not take is lost, as on a serial port.
    static_cast<void>(simulation_.session().offboard().send(command));
  } else {
    simulation_.tell(command);
  }
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

/// As a companion does in a mission, whose attitude is good: without it the firmware's tilt drifts when it accelerates.
void Learner::share_attitude() {
  const sim::Quaternion& q = truth().body.q_WB;
  link::ExternalAttitude attitude;
  attitude.q_WB = {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
                   static_cast<float>(q.z())};
  simulation_.tell(attitude);
}

Learner::Result Learner::step(const Action& action) {
  action_ = action;
  map_.begin(task_->flown(action), map_.depends_on_state() ? seen() : SeenState{});
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
