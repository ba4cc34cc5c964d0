// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

#include "flight/fly.hpp"
#include "log/log_observer.hpp"
#include "web/server/access.hpp"

namespace rosflight::viewer {

/// A view of the running flight, for programs that have one.
class FlightWatch {
 public:
  virtual ~FlightWatch() = default;
  virtual log::LogObserver& observer() = 0;
  virtual flight::Commander& commander() = 0;
  /// The flight has ended and its folder is written; returns when nobody wants to look any more, or
  /// somebody wants another flight. @returns its mission, empty: the same; nothing: none.
  virtual std::optional<std::string> stay(const flight::FlightSummary& summary) = 0;
};

/// Serves the page with a flight that is about to run, and after it until Ctrl-C. Prints its address
/// to `err`. What the page shows are the messages of the log. @param hold  the simulated pilot waits with
/// arming for a viewer. @throws config::Error  no page, or it cannot listen there.
std::unique_ptr<FlightWatch> watch_flight(const web::server::Access& access, bool hold,
                                          std::ostream& err);

}  // namespace rosflight::viewer
