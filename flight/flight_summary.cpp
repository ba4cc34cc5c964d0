// SPDX-License-Identifier: BSD-3-Clause
#include "flight/flight_summary.hpp"

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

}  // namespace rosflight::flight
