// SPDX-License-Identifier: BSD-3-Clause
#include "sim/lock_step.hpp"

namespace rosflight::sim {

LockStep::LockStep(TimeSource& time, RcModule& rc, SensorsModule& sensors,
                   AutopilotModule& autopilot, Dynamics& dynamics)
    : time_{time},
      rc_{rc},
      sensors_{sensors},
      autopilot_{autopilot},
      dynamics_{dynamics},
      now_{dynamics.truth().time} {}

void LockStep::begin_step() {
  const Time t = now_;
  if (listener_ != nullptr) listener_->before_step(t);
  has_frame_ = rc_.step(t, frame_);
  sensors_.step(dynamics_.truth(), samples_);
  const hal::OutputValues* outputs = &autopilot_.step(t, samples_, rc_frame());
  for (unsigned k = 1; k < substeps_; ++k) {
    const Time within = t + k * substep_;
    dynamics_.step(within, *outputs);
    sensors_.step(dynamics_.truth(), samples_);
    outputs = &autopilot_.step(within, samples_, nullptr);
  }
  if (listener_ != nullptr) listener_->after_autopilot(t, *outputs);
  now_ = time_.advance(t);
  outputs_ = outputs;
}

void LockStep::end_step() {
  for (Visualiser* visualiser : visualisers_) visualiser->step(dynamics_.truth(), *outputs_);
  ++ticks_;
}

void LockStep::step() {
  begin_step();
  dynamics_.step(now_, *outputs_);
  end_step();
}

std::uint64_t LockStep::run_until(Time end) {
  const std::uint64_t before = ticks_;
  while (now_ < end) step();
  return ticks_ - before;
}

}  // namespace rosflight::sim
