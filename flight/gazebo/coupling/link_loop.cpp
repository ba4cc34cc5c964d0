// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/link_loop.hpp"

#include <fmt/format.h>

#include <exception>
#include <utility>

#include "flight/flight.hpp"

namespace rosflight::flight::gazebo {
namespace {

double seconds(std::chrono::nanoseconds t) {
  return std::chrono::duration<double>(t).count();
}

}  // namespace

LinkCoupling::LinkCoupling(std::unique_ptr<LinkLoop> loop, Say say)
    : loop_{std::move(loop)}, say_{std::move(say)} {}

void LinkCoupling::give_up(const std::string& line) {
  say_(line + "; the vehicle is without forces from here on");
  loop_.reset();
  stepping_ = false;
}

bool LinkCoupling::in_step(const Time& time) {
  const std::chrono::nanoseconds firmware = Flight::kStep;
  if (time.step.count() <= 0 || firmware % time.step != std::chrono::nanoseconds{0}) {
    give_up(
        fmt::format("max_step_size: found {} s, allowed {} s, the step of the firmware, or a whole "
                    "part of it such as 0.00125 or 0.0005",
                    seconds(time.step), seconds(firmware)));
    return false;
  }
  if (reached_ && time.reached <= *reached_) {
    give_up(
        fmt::format("simulated time: found {} s after {} s, allowed later times; start the "
                    "simulator again",
                    seconds(time.reached), seconds(*reached_)));
    return false;
  }
  reached_ = time.reached;
  return true;
}

StepCommand LinkCoupling::before_step(const Time& time) {
  if (!loop_) return {};
  try {
    if (time.paused) {
      StepCommand command;
      command.run = loop_->while_paused();
      return command;
    }
    if (!in_step(time)) return {};
    stepping_ = true;
    return loop_->before_step(time.step);
  } catch (const std::exception& error) {
    give_up(error.what());
  }
  return {};
}

void LinkCoupling::after_step(const Time& time, const std::optional<LinkState>& state) {
  if (!loop_ || time.paused || !std::exchange(stepping_, false)) return;
  if (!state || !finite(*state)) return give_up("the simulator has no finite state of the link");
  try {
    loop_->after_step(*state);
  } catch (const std::exception& error) {
    give_up(error.what());
  }
}

}  // namespace rosflight::flight::gazebo
