// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_summary.hpp"

#include <fmt/format.h>

namespace rosflight::flight {

FlightSummary summarise(const Flight& flight, bool interrupted) {
  FlightSummary s;
  const MissionRunner& runner = flight.runner();
  s.choice = flight.setup().choice;
  const auto& faults = flight.setup().faults.faults();
  for (std::size_t k = 0; k < faults.size(); ++k) {
    if (faults[k].start >= flight.now()) s.faults_too_late.push_back(s.choice.faults[k]);
  }
  s.score = flight.score(interrupted);
  s.sim_time_s = sim::to_seconds(flight.now());
  if (runner.armed_at() > sim::Time{0})
    s.flight_time_s = sim::to_seconds(flight.now() - runner.armed_at());
  s.tracking = flight.tracking();
  s.own_tracking = flight.own_tracking();
  if (const FixedWingRecord* record = flight.fixedwing_record()) s.fixedwing = *record;
  s.landed = flight.autonomy().landed;
  s.disarmed = runner.disarmed();
  s.processor = flight.autopilot().figures();
  return s;
}

std::string command_line(const FlightChoice& choice) {
  std::string line = fmt::format("./rosflight fly --vehicle {} --mission {} --seed {}",
                                 choice.vehicle, choice.mission, choice.seed);
  if (choice.board != "in_process") line += " --board " + choice.board;
  if (choice.link != "cable") line += " --link " + choice.link;
  if (choice.state != FlightChoice{}.state) line += " --state " + choice.state;
  for (const std::string& text : choice.plugins) line += " --plugin " + text;
  if (choice.pilot != FlightChoice{}.pilot) line += " --pilot " + choice.pilot;
  if (choice.physics != FlightChoice{}.physics) line += " --physics " + choice.physics;
  if (!choice.world.empty()) line += " --world " + choice.world;
  if (choice.wind) line += " --wind " + *choice.wind;
  for (const std::string& text : choice.overrides) line += " --set " + text;
  for (const std::string& text : choice.faults) line += " --fault " + text;
  if (choice.link_protocol != FlightChoice{}.link_protocol) {
    line += " --link-protocol " + choice.link_protocol;
  }
  return line;
}

}  // namespace rosflight::flight
