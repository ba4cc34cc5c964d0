// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "sim/modules.hpp"

namespace rosflight::sim {

/// Takes part in the loop without being a module: the companion computer, a flight director,
/// faults.
class LockStepListener {
 public:
  virtual ~LockStepListener() = default;
  /// At the very beginning of the step at t, before RC and sensors.
  virtual void before_step(Time t) { static_cast<void>(t); }
  /// The board has run its step at t; what it wrote to the link is there to be read.
  virtual void after_board(Time t, const hal::OutputValues& outputs) {
    static_cast<void>(t), static_cast<void>(outputs);
  }
};

/// Wires the modules in one thread. One step, beginning at t:
///
///     listener      before_step(t)
///     RC            frame, if one arrives at t
///     sensors       samples that become available at t, from the truth at t
///     board         firmware pass with them -> outputs
///     listener      after_board(t): the companion reads and writes the link
///     time          t' = end of the step; a paced source waits here for the wall
///     dynamics      truth moves to t' under these outputs; it evaluates forces and moments
///     visualisers   see the truth at t' and the outputs that led to it, in the order they were
///     added
///
/// The order is the same in every step and nothing else calls the modules, so a run is a function
/// of their states alone. Owns references and one set of samples; allocates nothing while stepping.
class LockStep {
 public:
  /// Everything referred to must outlive this. Time starts at truth().time.
  LockStep(TimeSource& time, RcModule& rc, SensorsModule& sensors, BoardModule& board,
           Dynamics& dynamics);

  void add(Visualiser& visualiser) { visualisers_.push_back(&visualiser); }
  /// nullptr: none.
  void set_listener(LockStepListener* listener) { listener_ = listener; }

  void step();
  /// Steps while now() < end. @returns the number of steps.
  std::uint64_t run_until(Time end);

  /// Start of the next step.
  Time now() const { return now_; }
  std::uint64_t ticks() const { return ticks_; }
  /// What the sensors delivered and whether a receiver frame came in the last step.
  const SensorSamples& samples() const { return samples_; }
  const hal::RcFrame* rc_frame() const { return has_frame_ ? &frame_ : nullptr; }

 private:
  TimeSource& time_;
  RcModule& rc_;
  SensorsModule& sensors_;
  BoardModule& board_;
  Dynamics& dynamics_;
  LockStepListener* listener_{nullptr};
  std::vector<Visualiser*> visualisers_;
  SensorSamples samples_;
  hal::RcFrame frame_;
  bool has_frame_{false};
  Time now_;
  std::uint64_t ticks_{0};
};

}  // namespace rosflight::sim
