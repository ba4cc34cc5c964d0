// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "flight/commander.hpp"
#include "flight/repeat.hpp"
#include "viewer/simulation_changes.hpp"
#include "viewer/viewer_commands.hpp"

namespace rosflight::viewer {

/// What viewers of the page command during a simulated flight. Pauses in the thread of the flight.
class FlightCommander final : public flight::Commander {
 public:
  /// @param desk  must outlive this. @param hold  the pilot waits with arming for a viewer.
  /// @param stopped  asked while the simulation stands still.
  FlightCommander(web::server::CommandDesk& desk, bool hold, std::function<bool()> stopped);

  void begin(sim::PacedTime* pace) override;
  void step(flight::Flight& flight, sim::Time now,
            const flight::MissionRunner::Notify& note) override;
  bool ends(sim::Time next) const override;
  void end() override;

  /// After a flight: refuses commands until a viewer resets or stopped().
  /// @returns the mission to fly next, empty: the same; nothing: none.
  std::optional<std::string> next_mission();

 private:
  void publish();
  void after_flight(const web::server::CommandDesk::Command& command);

  web::server::CommandDesk& desk_;
  bool hold_;
  flight::FlightChoice choice_;  ///< Choice of the latest flight.
  std::function<bool()> stopped_;
  Pace pace_;
  flight::Flight* flight_{nullptr};  ///< While it flies.
  ViewerCommands commands_;
  sim::PacedTime* time_{nullptr};
};

/// Does in the same steps what viewers did in a recorded flight.
class RepeatCommander final : public flight::Commander {
 public:
  /// @param recorded  must outlive this.
  explicit RepeatCommander(const flight::RecordedFlight& recorded);

  void step(flight::Flight& flight, sim::Time now,
            const flight::MissionRunner::Notify& note) override;
  bool ends(sim::Time next) const override;
  void end() override {}

 private:
  const flight::RecordedFlight& recorded_;
  std::size_t next_{0};
  web::server::CommandDesk desk_;  ///< Nobody reads its answers.
  Pace pace_;                      ///< Has no effect on a recorded flight.
  flight::Flight* flight_{nullptr};
  ViewerCommands commands_;
};

}  // namespace rosflight::viewer
