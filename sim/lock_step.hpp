// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "sim/modules.hpp"

namespace rosflight::sim {

/// Participates in the loop without being a module: the companion computer, a mission runner,
/// faults.
class LockStepListener {
 public:
  virtual ~LockStepListener() = default;
  /// At the very beginning of the step at t, before RC and sensors.
  virtual void before_step(Time t) { static_cast<void>(t); }
  /// The autopilot has executed its step at t; the bytes that it sent can be read.
  virtual void after_autopilot(Time t, const hal::OutputValues& outputs) {
    static_cast<void>(t), static_cast<void>(outputs);
  }
};

/// Wires the modules in one thread. One step, beginning at t:
///
///     listener      before_step(t)
///     RC            frame, if one arrives at t
///     sensors       samples that become available at t, from the truth at t
///     autopilot     firmware pass with them -> outputs
///     listener      after_autopilot(t): the companion reads and writes the link
///     time          t' = end of the step; a paced source waits here for the wall
///     dynamics      truth moves to t' under these outputs; it evaluates forces and moments
///     visualisers   get the truth at t' and the outputs that led to it, in the order of add()
///
/// An autopilot that needs the world more often takes n substeps in each step: sensors, autopilot and
/// dynamics then have n turns, each with an n-th of the time, and all others one, with the receiver's
/// frame in the first.
///
/// The order is the same in every step and nothing else calls the modules, so a run is a function
/// of their states alone. Owns references and one set of samples; allocates nothing while stepping.
class LockStep {
 public:
  /// Everything referred to must outlive this. Time starts at truth().time.
  LockStep(TimeSource& time, RcModule& rc, SensorsModule& sensors, AutopilotModule& autopilot,
           Dynamics& dynamics);

  /// Adds a visualiser, which must outlive this; see the order above.
  void add(Visualiser& visualiser) { visualisers_.push_back(&visualiser); }
  /// nullptr: none.
  void set_listener(LockStepListener* listener) { listener_ = listener; }
  /// From the next step on `count` substeps of `length` each, which together are a step of the time source.
  void set_substeps(unsigned count, Time length) { substeps_ = count, substep_ = length; }

  /// Executes one step.
  void step();
  /// The same in two halves, for a world that another program moves in between: all up to the dynamics, which the owner
  /// moves to now() under outputs(); then the visualisers. Not with substeps.
  void begin_step();
  void end_step();
  /// Those of the last begin_step().
  const hal::OutputValues& outputs() const { return *outputs_; }
  /// Steps while now() < end. @returns the number of steps.
  std::uint64_t run_until(Time end);

  /// Start of the next step.
  Time now() const { return now_; }
  std::uint64_t ticks() const { return ticks_; }
  /// Samples and receiver frame of the last step.
  const SensorSamples& samples() const { return samples_; }
  const hal::RcFrame* rc_frame() const { return has_frame_ ? &frame_ : nullptr; }

 private:
  TimeSource& time_;
  RcModule& rc_;
  SensorsModule& sensors_;
  AutopilotModule& autopilot_;
  Dynamics& dynamics_;
  LockStepListener* listener_{nullptr};
  std::vector<Visualiser*> visualisers_;
  SensorSamples samples_;
  hal::RcFrame frame_;
  bool has_frame_{false};
  unsigned substeps_{1};
  Time substep_{};
  const hal::OutputValues* outputs_{nullptr};  ///< The autopilot's.
  Time now_;
  std::uint64_t ticks_{0};
};

}  // namespace rosflight::sim
