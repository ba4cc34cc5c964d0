// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/learner.hpp"

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

}  // namespace

Learner::Learner(flight::FlightSetup& setup, const TaskConfig& task, const std::string& level,
                 std::uint64_t seed)
    : config_{task},
      map_{setup, level},
      seed_{seed},
      simulation_{(setup.choice.seed = seed, setup)},
      task_{Task::make(task, setup, simulation_.truth().body.p_W)},
      random_{episodes(seed)} {}

void Learner::start() {
  simulation_.start();
  map_.read_mixer(simulation_.firmware());
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
  armed_ = simulation_.save();
}

void Learner::rewind() {
  simulation_.restore(*armed_);
  random_ = episodes(seed_);
  begin_episode();
}

void Learner::begin_episode() {
  simulation_.restore_firmware(*armed_);
  map_.restart();
  const Task::Start start = task_->begin(random_);
  const bool own = !start.module_state.empty();
  if (!simulation_.set_state(start.body, own ? start.module_state : hovering_))
    throw config::Error("reset: found a start below the ground, allowed above it");
  action_ = {};
  steps_ = 0;
}

link::OffboardControl Learner::command() {
  const SeenState seen = map_.depends_on_state() ? SeenState::of(truth()) : SeenState{};
  return map_.command(seen, kCommandSteps * kStep_s, truth().battery_voltage_V);
}

Learner::Result Learner::step(const Action& action, int substeps) {
  action_ = action;
  map_.begin(action, SeenState::of(truth()));
  for (int k = 0; k < substeps; ++k) {
    if (k % kCommandSteps == 0) simulation_.tell(command());
    simulation_.step();
    task_->advance(truth());
  }
  steps_ += substeps;

  const Task::Verdict verdict = task_->judge(truth(), substeps * kStep_s);
  const bool lost = verdict.lost || !simulation_.firmware().state().armed();
  constexpr double kCrash = 2.0;
  Result result;
  result.reward = static_cast<float>(verdict.reward - (lost ? kCrash : 0.0));
  result.terminated = lost || verdict.done;
  result.truncated = !result.terminated && steps_ * kStep_s >= config_.episode_s;
  result.success = !lost && verdict.success && (result.terminated || result.truncated);
  return result;
}

void Learner::observe(float* out) const {
  const SeenState seen = SeenState::of(truth());
  const auto put = [&out](const auto& v) {
    for (int k = 0; k < 3; ++k) *out++ = static_cast<float>(v[k]);
  };
  put(to_target(seen.p_W));
  put(seen.v_W);
  const sim::Matrix3 R_WB = seen.q_WB.toRotationMatrix();
  for (int row = 0; row < 3; ++row) put(R_WB.row(row));
  put(seen.w_B);
  out = std::ranges::copy(action_, out).out;
  task_->observe(seen, out);
}

}  // namespace rosflight::python
