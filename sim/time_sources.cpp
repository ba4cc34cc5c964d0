// SPDX-License-Identifier: BSD-3-Clause
#include "sim/time_sources.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>

namespace rosflight::sim {
namespace {
Time checked_step(Time step) {
  if (step <= Time{0}) {
    throw std::invalid_argument("time step " + std::to_string(step.count()) +
                                " us is not positive");
  }
  return step;
}

double checked_factor(double factor) {
  if (!(factor > 0.0) || !std::isfinite(factor)) {
    throw std::invalid_argument("pace " + std::to_string(factor) + " is not a number above 0");
  }
  return factor;
}
}  // namespace

LockStepTime::LockStepTime(Time step) : step_{checked_step(step)} {}

Time SteadyWallClock::now() {
  return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now().time_since_epoch());
}

void SteadyWallClock::sleep_until(Time wall) {
  std::this_thread::sleep_until(std::chrono::steady_clock::time_point{wall});
}

PacedTime::PacedTime(Time step, double factor, WallClock& wall)
    : step_{checked_step(step)}, factor_{checked_factor(factor)}, wall_{wall} {}

void PacedTime::set_factor(double factor) {
  factor_ = checked_factor(factor);
  anchored_ = false;
}

Time PacedTime::advance(Time now) {
  if (!anchored_) {
    anchored_ = true;
    sim_anchor_ = now;
    wall_anchor_ = wall_.now();
  }
  const Time next = now + step_;
  const auto simulated_us = static_cast<double>((next - sim_anchor_).count());
  const Time due = wall_anchor_ + Time{std::llround(simulated_us / factor_)};
  const Time wall = wall_.now();
  if (wall < due) {
    wall_.sleep_until(due);
  } else if (wall - due > kMaxDelay) {
    sim_anchor_ = next;
    wall_anchor_ = wall;
    ++slips_;
  }
  return next;
}

}  // namespace rosflight::sim
