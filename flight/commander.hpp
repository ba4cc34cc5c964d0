// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "companion/session.hpp"
#include "flight/mission_runner.hpp"

namespace rosflight::flight {

/// Somebody who commands the vehicle while it flies, such as a viewer of the page. What is commanded is a
/// part of the flight: it enters at the beginning of a step, and its log says so.
class Commander {
 public:
  virtual ~Commander() = default;
  /// Called in each step before the firmware runs, in the thread of the flight.
  /// @param note  takes a line for the log. @param now  the time of this step.
  virtual void step(companion::Session& session, sim::Time now,
                    const MissionRunner::Notify& note) = 0;
  /// After the last step.
  virtual void end() = 0;
};

}  // namespace rosflight::flight
