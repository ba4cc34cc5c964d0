// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/flight.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::flight {

/// Somebody who commands the vehicle, and changes the simulation, while it flies, such as a viewer of the
/// page. What is commanded is a part of the flight: it enters at the beginning of a step, and its log contains it.
class Commander {
 public:
  virtual ~Commander() = default;
  /// A flight is about to begin. @param pace  its pace; nullptr: as fast as possible.
  virtual void begin(sim::PacedTime* pace) { static_cast<void>(pace); }
  /// Called in each step before the firmware runs, in the thread of the flight.
  /// @param note  takes a line for the log. @param now  the time of this step.
  virtual void step(Flight& flight, sim::Time now, const MissionRunner::Notify& note) = 0;
  /// Asked before each step: the flight ends before the step at `next`.
  virtual bool ends(sim::Time next) const {
    static_cast<void>(next);
    return false;
  }
  /// Called after the last step.
  virtual void end() = 0;
};

}  // namespace rosflight::flight
